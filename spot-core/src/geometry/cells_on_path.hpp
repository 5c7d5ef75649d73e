// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "spot/geometry/outlets.hpp"
#include "spot/geometry/periodic.hpp"
#include "spot/geometry/wall_contact.hpp"

namespace spot {

/// The shares of a straight path at which it passes from cell to cell, in increasing order, and 1 for its end.
inline std::vector<double> ends_of_pieces(const Periodic& periodic, const Vector3& from, const Vector3& to) {
  std::vector<double> ends = {1.0};
  for (int axis = 0; axis < 2; ++axis) {
    if (!periodic.along(axis) || from[axis] == to[axis]) continue;
    const double least = std::min(from[axis], to[axis]), most = std::max(from[axis], to[axis]);
    double border =
        periodic.low(axis) + std::ceil((least - periodic.low(axis)) / periodic.length(axis)) * periodic.length(axis);
    for (; border < most; border += periodic.length(axis))
      if (border > least) ends.push_back((border - from[axis]) / (to[axis] - from[axis]));
  }
  std::sort(ends.begin(), ends.end());
  return ends;
}

/// The first wall on a straight path through space that repeats; first_wall(from, to) says it of paths in the cell.
template <typename FirstWall>
std::optional<WallOnPath> first_in_cells(const Periodic& periodic, const Vector3& from, const Vector3& to,
                                         const FirstWall& first_wall) {
  double begin = 0.0;
  for (const double end : ends_of_pieces(periodic, from, to)) {
    const Vector3 first = from + begin * (to - from), last = end == 1.0 ? to : from + end * (to - from);
    const Vector3 middle = 0.5 * (first + last), into_cell = periodic.wrap(middle) - middle;
    if (auto wall = first_wall(first + into_cell, last + into_cell)) {
      wall->share = begin + wall->share * (end - begin);
      return wall;
    }
    begin = end;
  }
  return std::nullopt;
}

/// Is something true of an image of a place, of that nearest to the axis of an outlet? Below one, grains may have gone
/// on into the next cell.
template <typename IsTrue>
bool any_image_at_outlets(const Outlets& outlets, const Periodic& periodic, const Vector3& place,
                          const IsTrue& is_true) {
  return std::any_of(outlets.begin(), outlets.end(), [&](const Outlet& outlet) {
    return is_true(Vector3(outlet.centre + periodic.nearest(Vector3(place - outlet.centre))));
  });
}

}  // namespace spot
