// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/relaxation/support.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace spot {

namespace {

/// Slope of the ground on which a grain has to stay, and of a way that it does not roll down.
constexpr double tilt = 0.1, level = 0.05;

/// Of a unit vector that no contact is to block.
constexpr double rounding = 1e-9;

bool is_open(const Vector3& way, const std::vector<Vector3>& normals) {
  return std::all_of(normals.begin(), normals.end(), [&](const Vector3& n) { return way.dot(n) >= -rounding; });
}

/// Does this way, of any length, lead down, and does nothing block it?
bool leads_down(Vector3 way, const Vector3& gravity, const std::vector<Vector3>& normals) {
  const double length = way.norm();
  if (length < rounding) return false;
  way /= length;
  return way.dot(gravity) > level && is_open(way, normals);
}

/// The steepest way that contacts leave open is free fall, a slide off one of them, or a roll along two.
bool holds_against(const Vector3& gravity, const std::vector<Vector3>& normals) {
  if (leads_down(gravity, gravity, normals)) return false;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (leads_down(gravity - gravity.dot(normals[i]) * normals[i], gravity, normals)) return false;
    for (std::size_t j = 0; j < i; ++j) {
      const Vector3 along = normals[i].cross(normals[j]);
      if (leads_down(along, gravity, normals) || leads_down(-along, gravity, normals)) return false;
    }
  }
  return true;
}

}  // namespace

bool holds(const std::vector<Vector3>& normals) {
  return holds_against({tilt, 0.0, -1.0}, normals) && holds_against({-tilt, 0.0, -1.0}, normals) &&
         holds_against({0.0, tilt, -1.0}, normals) && holds_against({0.0, -tilt, -1.0}, normals);
}

}  // namespace spot
