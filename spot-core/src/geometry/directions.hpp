// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "spot/base/errors.hpp"
#include "spot/base/vector.hpp"

namespace spot {

/// A unit vector across a unit vector.
inline Vector3 across(const Vector3& direction) {
  Eigen::Index least = 0;
  direction.cwiseAbs().minCoeff(&least);
  return direction.cross(Vector3::Unit(least)).normalized();
}

/// A direction in the plane of two unit vectors that are across each other, after about so many turns from the first to
/// the second; exactly so for multiples of 1/4. Four rational arcs (tangent of half the angle) instead of sine and
/// cosine, for speed: smooth, and evenly spread within a fifth.
inline Vector3 around(double turns, const Vector3& first, const Vector3& second) {
  constexpr double eighth = 0.41421356237309503;  // tan(pi / 8)
  const double nearest = std::floor(4.0 * turns + 0.5);
  const double t = 2.0 * eighth * (4.0 * turns - nearest), scale = 1.0 / (1.0 + t * t);
  const double along = scale * (1.0 - t * t), beside = scale * 2.0 * t;
  switch (static_cast<long long>(nearest) & 3) {
    case 0:
      return along * first + beside * second;
    case 1:
      return along * second - beside * first;
    case 2:
      return -along * first - beside * second;
    default:
      return beside * first - along * second;
  }
}

/// The direction of a vector; throws InvalidContainer, naming what it is of, if it is zero or not finite.
inline Vector3 direction_of(const Vector3& vector, const char* what) {
  const double norm = vector.norm();
  if (!(norm > 0.0) || !std::isfinite(norm))
    throw InvalidContainer(
        message(what, " is (", vector.x(), ", ", vector.y(), ", ", vector.z(), ") but must be finite and not zero"));
  return vector / norm;
}

inline void require_finite(const Vector3& place, const char* what) {
  if (!place.allFinite())
    throw InvalidContainer(message(what, " is (", place.x(), ", ", place.y(), ", ", place.z(), ") but must be finite"));
}

inline void require_positive(double number, const char* what) {
  if (!(number > 0.0) || !std::isfinite(number))
    throw InvalidContainer(message(what, " is ", number, " but must be positive and finite"));
}

/// One of the two opposite directions: that whose last component that is not 0 is positive.
inline bool points_up(const Vector3& direction) {
  constexpr double none = 1e-12;
  for (const int axis : {2, 1, 0})
    if (std::abs(direction[axis]) > none) return direction[axis] > 0.0;
  return true;
}

}  // namespace spot
