// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/silo_width.hpp"

#include <algorithm>

namespace spot {

std::optional<double> silo_width(const Container& container, const Outlet& outlet) {
  constexpr double farthest = 30.0;
  const double radius = outlet.hole->widest_radius(), reach = farthest * radius;
  const Vector3 from = outlet.centre + radius * Vector3::UnitZ();
  std::optional<double> width;
  for (int axis = 0; axis < 2; ++axis) {
    if (outlet.hole->half_width(axis) > radius) continue;  // the ends of a slot
    for (const double side : {-1.0, 1.0})
      if (const auto wall = container.first_wall(from, from + side * reach * Vector3::Unit(axis)))
        width = std::min(width.value_or(2.0 * reach), 2.0 * wall->share * reach);
  }
  return width;
}

}  // namespace spot
