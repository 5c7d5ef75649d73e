// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "spot/geometry/wall.hpp"

namespace spot {

/// The inside of an upright cylinder around the vertical axis through (x, y).
class CylinderWall : public Wall {
 public:
  /// Throws InvalidContainer unless the radius is positive.
  CylinderWall(double x, double y, double radius);
  WallContact nearest(const Vector3& centre) const override;
  bool curved() const override { return true; }
  std::optional<WallOnPath> meet(const Vector3& from, const Vector3& to) const override;

 private:
  double x_, y_, radius_;
};

}  // namespace spot
