// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/outlet.hpp"

#include "geometry/directions.hpp"
#include "spot/geometry/round_hole.hpp"

namespace spot {

Outlet::Outlet(const Orifice& orifice) : Outlet(orifice.centre, std::make_shared<RoundHole>(orifice.radius)) {}

Outlet::Outlet(const Vector3& place, std::shared_ptr<const Hole> shape) : centre(place), hole(std::move(shape)) {
  require_finite(centre, "the centre of the orifice");
}

std::string Outlet::name() const {
  return message(hole->name(), " at (", centre.x(), ", ", centre.y(), ", ", centre.z(), ")");
}

}  // namespace spot
