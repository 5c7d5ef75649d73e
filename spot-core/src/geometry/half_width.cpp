// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/half_width.hpp"

#include <algorithm>

namespace spot {

double half_width(const Container& container, const Vector3& place, double farthest) {
  constexpr double narrowest = 1e-3;  // of the farthest: for a place that a wall passes through
  double inverse = 0.0;
  for (int axis = 0; axis < 2; ++axis) {
    double way = 0.0;
    for (const double side : {-1.0, 1.0}) {
      const auto wall = container.first_wall(place, place + side * farthest * Vector3::Unit(axis));
      way += (wall ? wall->share : 1.0) * farthest;
    }
    inverse += 2.0 / std::max(way, narrowest * farthest);
  }
  return 1.0 / inverse;
}

}  // namespace spot
