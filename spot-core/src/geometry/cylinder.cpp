// SPDX-License-Identifier: GPL-2.0-or-later
#include "geometry/directions.hpp"
#include "spot/geometry/shapes.hpp"

namespace spot {

namespace {

class Cylinder : public Surface {
 public:
  Cylinder(const Vector3& point, const Vector3& axis, double radius)
      : point_(point), axis_(axis), first_(across(axis)), second_(axis.cross(first_)), radius_(radius) {}

  double depth(const Vector3& place) const override { return radius_ - out(place - point_).norm(); }

  Vector3 nearest(const Vector3& place) const override {
    const Vector3 outwards = out(place - point_);
    const double distance = outwards.norm();
    if (distance == 0.0) return place + radius_ * first_;  // on the axis every direction is as good
    return place + (radius_ / distance - 1.0) * outwards;
  }

  Vector3 normal(const Vector3& point) const override { return -out(point - point_).normalized(); }

  Quadratic along(const Line& line) const override {
    const Vector3 start = out(line.origin - point_), step = out(line.direction);
    return {step.squaredNorm(), start.dot(step), start.squaredNorm() - radius_ * radius_};
  }

  std::array<double, 7> numbers(double size) const override {
    const Vector3 at = out(point_);
    return {at.x(), at.y(), at.z(), size * axis_.x(), size * axis_.y(), size * axis_.z(), radius_};
  }

  std::shared_ptr<const Surface> moved(const Vector3& by) const override {
    return std::make_shared<Cylinder>(point_ + by, axis_, radius_);
  }

  double slant(const Vector3& direction) const override { return axis_.cross(direction).norm(); }

  bool revolves_about(const Line& axis, double tolerance) const override {
    return slant(axis.direction) < 1e-12 && out(axis.origin - point_).norm() < tolerance;
  }

  std::optional<Line> axis() const override { return Line{point_, axis_}; }

  Line generator(double turns) const override { return {point_ + radius_ * around(turns, first_, second_), axis_}; }

 private:
  /// The part across the axis.
  Vector3 out(const Vector3& vector) const { return vector - axis_.dot(vector) * axis_; }

  Vector3 point_, axis_, first_, second_;
  double radius_;
};

}  // namespace

Solid cylinder(const Vector3& point, const Vector3& axis, double radius) {
  require_finite(point, "the point of a cylinder");
  require_positive(radius, "the radius of a cylinder");
  const Vector3 along = direction_of(axis, "the axis of a cylinder");
  return Solid(std::make_shared<Cylinder>(point, points_up(along) ? along : Vector3(-along), radius), true);
}

Solid cylinder_between(const Vector3& from, const Vector3& to, double radius) {
  const Solid endless = cylinder(from, to - from, radius);
  return endless & half_space(from, to - from) & half_space(to, from - to);
}

}  // namespace spot
