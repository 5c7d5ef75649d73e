// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/half_width.hpp"

#include <algorithm>

namespace spot {

namespace {

/// Moves a place to the middle of the free way through it along an axis, and returns half of that way.
double to_middle(const Container& container, double farthest, int axis, Vector3& place) {
  const Vector3 along = farthest * Vector3::Unit(axis);
  const auto behind = container.first_wall(place, place - along), ahead = container.first_wall(place, place + along);
  const double back = behind ? behind->share : 1.0, forth = ahead ? ahead->share : 1.0;
  place += 0.5 * (forth - back) * along;
  return 0.5 * (forth + back) * farthest;
}

}  // namespace

double half_width(const Container& container, const Vector3& place, double farthest) {
  constexpr double narrowest = 1e-3;  // of the farthest
  Vector3 middle = place;
  double x = 0.0, y = 0.0;
  for (int round = 0; round < 2; ++round) {
    x = to_middle(container, farthest, 0, middle);
    y = to_middle(container, farthest, 1, middle);
  }
  return 1.0 / (1.0 / std::max(x, narrowest * farthest) + 1.0 / std::max(y, narrowest * farthest));
}

}  // namespace spot
