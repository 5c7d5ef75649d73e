// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <memory>
#include <string>

#include "spot/base/vector.hpp"
#include "spot/geometry/hole.hpp"
#include "spot/geometry/orifice.hpp"

namespace spot {

/// Where grains leave and spots enter: a horizontal hole. How many spots enter when, Injection says.
struct Outlet {
  /// Both throw InvalidContainer unless the centre is finite, and as the hole does.
  Outlet(const Orifice& orifice);
  Outlet(const Vector3& place, std::shared_ptr<const Hole> shape);

  /// As of Hole: below 0 over and under the hole.
  double distance(const Vector3& place) const { return hole->distance(place - centre); }

  /// What errors call it, with its place.
  std::string name() const;

  Vector3 centre;
  std::shared_ptr<const Hole> hole;
};

}  // namespace spot
