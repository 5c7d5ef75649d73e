// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <memory>

#include "spot/geometry/surface.hpp"

namespace spot {

class Sphere : public Surface {
 public:
  Sphere(const Vector3& centre, double radius) : centre_(centre), radius_(radius) {}
  double depth(const Vector3& place) const override { return radius_ - (place - centre_).norm(); }
  Vector3 nearest(const Vector3& place) const override;
  Vector3 normal(const Vector3& point) const override { return (centre_ - point).normalized(); }
  Quadratic along(const Line& line) const override;
  std::array<double, 7> numbers(double) const override { return {centre_.x(), centre_.y(), centre_.z(), radius_}; }
  std::shared_ptr<const Surface> moved(const Vector3& by) const override {
    return std::make_shared<Sphere>(centre_ + by, radius_);
  }
  bool revolves_about(const Line& axis, double tolerance) const override;

  const Vector3& centre() const { return centre_; }
  double radius() const { return radius_; }

 private:
  Vector3 centre_;
  double radius_;
};

}  // namespace spot
