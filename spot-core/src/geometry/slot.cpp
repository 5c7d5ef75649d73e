// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/slot.hpp"

#include <algorithm>

#include "geometry/directions.hpp"
#include "geometry/length.hpp"
#include "spot/geometry/shapes.hpp"

namespace spot {

Slot::Slot(double x_width, double y_width) : half_(0.5 * x_width, 0.5 * y_width, 0.0) {
  require_positive(2.0 * half_.x(), "the width of the slot along x");
  require_positive(2.0 * half_.y(), "the width of the slot along y");
}

std::string Slot::name() const {
  const std::string name = message("slot of ", 2.0 * half_.x(), " by ", 2.0 * half_.y());
  return endless_ ? message(name, " without ends along ", "xy"[*endless_]) : name;
}

double Slot::distance(const Vector3& place) const {
  const double x = std::abs(place.x()) - half_.x(), y = std::abs(place.y()) - half_.y();
  if (endless_) return *endless_ == 0 ? y : x;
  return x > 0.0 && y > 0.0 ? length(x, y) : std::max(x, y);
}

Vector3 Slot::to_rim(const Vector3& place) const {
  int axis = std::abs(place.x()) - half_.x() >= std::abs(place.y()) - half_.y() ? 0 : 1;
  if (endless_) axis = 1 - *endless_;
  if (place[axis] == 0.0) return Vector3::Zero();
  return std::copysign(1.0, place[axis]) * Vector3::Unit(axis);
}

Vector3 Slot::keep_inside(double margin, const Vector3& place) const {
  Vector3 inside = place;
  for (int axis = 0; axis < 2; ++axis) {
    const double limit = std::max(0.0, half_[axis] - margin), off = std::abs(place[axis]);
    if (ends(axis) && off > limit) inside[axis] = std::copysign(std::max(0.0, 2.0 * limit - off), place[axis]);
  }
  return inside;
}

Vector3 Slot::point(double margin, double first, double second) const {
  const auto reach = [&](int axis) { return ends(axis) ? std::max(0.0, half_[axis] - margin) : half_[axis]; };
  return {(2.0 * first - 1.0) * reach(0), (2.0 * second - 1.0) * reach(1), 0.0};
}

double Slot::widest_radius() const { return endless_ ? half_[1 - *endless_] : std::min(half_.x(), half_.y()); }

double Slot::equivalent_radius() const {
  constexpr double pi = 3.14159265358979323846;
  return std::sqrt(4.0 * half_.x() * half_.y() / pi);
}

double Slot::farthest(const Vector3& place) const {
  return length(std::abs(place.x()) + half_.x(), std::abs(place.y()) + half_.y());
}

double Slot::discharge(const BeverlooLaw& law, double diameter) const {
  const double less = law.margin * diameter, wide = 2.0 * widest_radius() - less,
               length = endless_ ? 2.0 * half_[*endless_] : 2.0 * std::max(half_.x(), half_.y()) - less;
  return wide > 0.0 ? law.slot * length * wide * std::sqrt(wide) : 0.0;
}

std::shared_ptr<const Hole> Slot::without_ends(int axis) const {
  const auto endless = std::make_shared<Slot>(*this);
  endless->endless_ = axis;
  return endless;
}

Solid Slot::column(const Vector3& centre) const {
  const auto between = [&](int axis) {
    const Vector3 out = Vector3::Unit(axis);
    return half_space(centre + half_[axis] * out, -out) & half_space(centre - half_[axis] * out, out);
  };
  return endless_ ? between(1 - *endless_) : between(0) & between(1);
}

}  // namespace spot
