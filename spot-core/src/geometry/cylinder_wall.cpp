// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/cylinder_wall.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/length.hpp"
#include "spot/base/errors.hpp"

namespace spot {

CylinderWall::CylinderWall(double x, double y, double radius) : x_(x), y_(y), radius_(radius) {
  if (!(radius > 0.0) || !std::isfinite(radius))
    throw InvalidContainer(message("cylinder radius is ", radius, " but must be positive and finite"));
}

WallContact CylinderWall::nearest(const Vector3& centre) const {
  const double dx = centre.x() - x_;
  const double dy = centre.y() - y_;
  const double distance = length(dx, dy);
  if (distance == 0.0) return {radius_, {-1.0, 0.0, 0.0}};  // on the axis every direction is as good
  return {radius_ - distance, {-dx / distance, -dy / distance, 0.0}};
}

std::optional<WallOnPath> CylinderWall::meet(const Vector3& from, const Vector3& to) const {
  if (nearest(to).distance >= 0.0) return std::nullopt;
  if (nearest(from).distance <= 0.0) return WallOnPath{0.0, nearest(from).normal};
  // The share s of the path at which |start + s along| is the radius: the larger root of a s^2 + 2 b s - c.
  const Eigen::Vector2d start(from.x() - x_, from.y() - y_), along = (to - from).head<2>();
  const double a = along.squaredNorm(), b = start.dot(along), c = radius_ * radius_ - start.squaredNorm();
  const double root = std::sqrt(b * b + a * c);
  const double share = std::min(1.0, b > 0.0 ? c / (b + root) : (root - b) / a);
  return WallOnPath{share, nearest(from + share * (to - from)).normal};
}

}  // namespace spot
