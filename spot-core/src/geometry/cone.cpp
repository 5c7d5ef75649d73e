// SPDX-License-Identifier: GPL-2.0-or-later
#include "geometry/directions.hpp"
#include "spot/geometry/shapes.hpp"

namespace spot {

namespace {

/// One nappe. In the half plane of (distance from the axis, height above the point) it is the ray (sine, cosine) of its
/// half angle.
class Cone : public Surface {
 public:
  Cone(const Vector3& point, const Vector3& axis, double slope)
      : point_(point),
        axis_(axis),
        first_(across(axis)),
        second_(axis.cross(first_)),
        slope_(slope),
        cosine_(1.0 / std::sqrt(1.0 + slope * slope)),
        sine_(slope * cosine_) {}

  double depth(const Vector3& place) const override {
    const Vector3 from_point = place - point_;
    const double height = axis_.dot(from_point), distance = (from_point - height * axis_).norm();
    if (distance * sine_ + height * cosine_ <= 0.0) return -from_point.norm();
    return height * sine_ - distance * cosine_;
  }

  Vector3 nearest(const Vector3& place) const override {
    const Vector3 from_point = place - point_;
    const double height = axis_.dot(from_point), distance = (from_point - height * axis_).norm();
    const double along = distance * sine_ + height * cosine_;
    if (along <= 0.0) return point_;
    return point_ + along * (sine_ * outwards(from_point) + cosine_ * axis_);
  }

  Vector3 normal(const Vector3& point) const override {
    if (point == point_) return axis_;
    return sine_ * axis_ - cosine_ * outwards(point - point_);
  }

  /// That of both nappes.
  Quadratic along(const Line& line) const override {
    const Vector3 start = line.origin - point_;
    const double up = axis_.dot(start), rise = axis_.dot(line.direction);
    const Vector3 out = start - up * axis_, step = line.direction - rise * axis_;
    const double s2 = sine_ * sine_, c2 = cosine_ * cosine_;
    return {s2 * rise * rise - c2 * step.squaredNorm(), s2 * up * rise - c2 * out.dot(step),
            s2 * up * up - c2 * out.squaredNorm()};
  }

  std::array<double, 7> numbers(double size) const override {
    return {point_.x(), point_.y(), point_.z(), size * axis_.x(), size * axis_.y(), size * axis_.z(), size * slope_};
  }

  std::shared_ptr<const Surface> moved(const Vector3& by) const override {
    return std::make_shared<Cone>(point_ + by, axis_, slope_);
  }

  bool revolves_about(const Line& axis, double tolerance) const override {
    return axis_.cross(axis.direction).norm() < 1e-12 &&
           (point_ - axis.origin).cross(axis.direction).norm() < tolerance;
  }

  std::optional<Line> axis() const override { return Line{point_, axis_}; }

  Line generator(double turns) const override {
    return {point_, sine_ * around(turns, first_, second_) + cosine_ * axis_};
  }

  std::optional<Vector3> apex() const override { return point_; }

 private:
  /// The direction away from the axis; on it every one is as good.
  Vector3 outwards(const Vector3& from_point) const {
    const Vector3 out = from_point - axis_.dot(from_point) * axis_;
    const double distance = out.norm();
    return distance > 0.0 ? Vector3(out / distance) : first_;
  }

  Vector3 point_, axis_, first_, second_;
  double slope_, cosine_, sine_;
};

}  // namespace

Solid cone(const Vector3& point, const Vector3& axis, double slope) {
  require_finite(point, "the point of a cone");
  require_positive(slope, "the slope of a cone");
  return Solid(std::make_shared<Cone>(point, direction_of(axis, "the axis of a cone"), slope), true);
}

Solid cone_between(const Vector3& from, double radius_from, const Vector3& to, double radius_to) {
  if (radius_from > radius_to) return cone_between(to, radius_to, from, radius_from);
  if (!(radius_from >= 0.0) || !(radius_to > radius_from) || !std::isfinite(radius_to))
    throw InvalidContainer(message("the radii of a cone are ", radius_from, " and ", radius_to,
                                   " but must be finite, not negative, and different: a cylinder has equal ones"));
  const Vector3 axis = to - from;
  const double share = radius_from / (radius_to - radius_from);
  const Solid endless = cone(from - share * axis, axis, (radius_to - radius_from) / axis.norm());
  const Solid ended = endless & half_space(to, -axis);
  return radius_from > 0.0 ? ended & half_space(from, axis) : ended;
}

}  // namespace spot
