// SPDX-License-Identifier: GPL-2.0-or-later
#include "geometry/sphere.hpp"

#include "geometry/directions.hpp"
#include "spot/geometry/shapes.hpp"

namespace spot {

Vector3 Sphere::nearest(const Vector3& place) const {
  const Vector3 out = place - centre_;
  const double distance = out.norm();
  return centre_ + (distance > 0.0 ? Vector3(radius_ / distance * out) : Vector3(radius_, 0.0, 0.0));
}

Quadratic Sphere::along(const Line& line) const {
  const Vector3 out = line.origin - centre_;
  return {line.direction.squaredNorm(), out.dot(line.direction), out.squaredNorm() - radius_ * radius_};
}

bool Sphere::revolves_about(const Line& axis, double tolerance) const {
  return (centre_ - axis.origin).cross(axis.direction).norm() < tolerance;
}

Solid sphere(const Vector3& centre, double radius) {
  require_finite(centre, "the centre of a sphere");
  require_positive(radius, "the radius of a sphere");
  return Solid(std::make_shared<Sphere>(centre, radius), true);
}

}  // namespace spot
