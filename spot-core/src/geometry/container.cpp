// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/container.hpp"

#include <algorithm>

#include "spot/base/errors.hpp"

namespace spot {

Vector3 Container::keep_spot_inside(const Vector3& start, const Vector3& target) const {
  if (const auto end = reflect_spot(start, target)) return *end;
  const Vector3 upwards(start.x(), start.y(), target.z());
  return first_wall(start, upwards) ? start : upwards;
}

const std::vector<AxisPlane>& Container::axis_planes() const {
  static const std::vector<AxisPlane> none;
  return none;
}

const Periodic& Container::periodic() const {
  static const Periodic none;
  return none;
}

bool Container::is_over_outlet(const Vector3& place, double margin) const {
  return std::any_of(outlets().begin(), outlets().end(), [&](const Outlet& outlet) {
    return outlet.hole->distance(periodic().nearest(Vector3(place - outlet.centre))) <= margin;
  });
}

const Outlet& Container::nearest_outlet(const Vector3& place) const {
  const auto distance = [&](const Outlet& outlet) {
    return outlet.distance(outlet.centre + periodic().nearest(Vector3(place - outlet.centre)));
  };
  return *std::min_element(outlets().begin(), outlets().end(),
                           [&](const Outlet& a, const Outlet& b) { return distance(a) < distance(b); });
}

std::size_t Container::nearest_outlet_index(const Vector3& place) const {
  return static_cast<std::size_t>(&nearest_outlet(place) - &outlets()[0]);
}

void Container::require_entrance(double spot_radius) const {
  for (const Outlet& outlet : outlets())
    if (outlet.hole->widest_radius() < spot_radius)
      throw InvalidContainer(
          message("orifice radius is ", outlet.hole->widest_radius(), " but must be at least the spot radius, ",
                  spot_radius, ": narrower orifices clog, which is outside the spot model (", outlet.name(), ")"));
}

}  // namespace spot
