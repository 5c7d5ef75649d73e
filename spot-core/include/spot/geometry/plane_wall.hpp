// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "spot/geometry/wall.hpp"

namespace spot {

/// The plane through `point` with grains on the side that `normal` points to.
class PlaneWall : public Wall {
 public:
  /// Throws InvalidContainer if the normal is zero or not finite.
  PlaneWall(const Vector3& point, const Vector3& normal);
  WallContact nearest(const Vector3& centre) const override;
  std::optional<WallOnPath> meet(const Vector3& from, const Vector3& to) const override;
  std::optional<AxisPlane> axis_plane() const override;

 private:
  Vector3 normal_;
  double offset_;
};

}  // namespace spot
