// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cmath>
#include <memory>

#include "spot/geometry/surface.hpp"

namespace spot {

/// The inner side is that to which the unit normal points.
class Plane : public Surface {
 public:
  Plane(const Vector3& point, const Vector3& normal) : normal_(normal), offset_(normal.dot(point)) {}
  double depth(const Vector3& place) const override { return normal_.dot(place) - offset_; }
  Vector3 nearest(const Vector3& place) const override { return place - depth(place) * normal_; }
  Vector3 normal(const Vector3&) const override { return normal_; }
  Quadratic along(const Line& line) const override {
    return {0.0, 0.5 * normal_.dot(line.direction), depth(line.origin)};
  }
  std::array<double, 7> numbers(double size) const override {
    return {size * normal_.x(), size * normal_.y(), size * normal_.z(), offset_};
  }
  std::shared_ptr<const Surface> moved(const Vector3& by) const override {
    return std::make_shared<Plane>(normal_ * offset_ + by, normal_);
  }
  double slant(const Vector3& direction) const override { return std::abs(normal_.dot(direction)); }
  bool revolves_about(const Line& axis, double tolerance) const override;

  double offset() const { return offset_; }

 private:
  Vector3 normal_;
  double offset_;
};

}  // namespace spot
