// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/plane_wall.hpp"

#include <cmath>

#include "spot/base/errors.hpp"

namespace spot {

PlaneWall::PlaneWall(const Vector3& point, const Vector3& normal) {
  const double norm = normal.norm();
  if (!(norm > 0.0) || !std::isfinite(norm) || !point.allFinite())
    throw InvalidContainer("a plane wall needs a finite point and a finite normal that is not zero");
  normal_ = normal / norm;
  offset_ = normal_.dot(point);
}

WallContact PlaneWall::nearest(const Vector3& centre) const { return {normal_.dot(centre) - offset_, normal_}; }

std::optional<WallOnPath> PlaneWall::meet(const Vector3& from, const Vector3& to) const {
  const double before = normal_.dot(from) - offset_, after = normal_.dot(to) - offset_;
  if (after >= 0.0) return std::nullopt;
  return WallOnPath{before > 0.0 ? before / (before - after) : 0.0, normal_};
}

std::optional<AxisPlane> PlaneWall::axis_plane() const {
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(normal_[axis]) == 1.0) return AxisPlane{axis, offset_ * normal_[axis], normal_[axis] < 0.0};
  return std::nullopt;
}

}  // namespace spot
