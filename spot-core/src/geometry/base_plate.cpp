// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/base_plate.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/length.hpp"

namespace spot {

BasePlate::BasePlate(const Outlets& outlets) : outlets_(outlets) {}

WallContact BasePlate::nearest(const Vector3& centre) const {
  const Outlet& outlet = outlets_.nearest(centre);
  const Vector3 place = centre - outlet.centre;
  const double height = place.z(), beside = outlet.hole->distance(place);
  if (beside >= 0.0) return {std::abs(height), {0.0, 0.0, height < 0.0 ? -1.0 : 1.0}};
  const Vector3 to_rim = outlet.hole->to_rim(place);
  const double distance = length(beside, height);
  if (to_rim.isZero(0.0)) return {distance, {0.0, 0.0, 1.0}};
  return {distance, {to_rim.x() * beside / distance, to_rim.y() * beside / distance, height / distance}};
}

Vector3 BasePlate::reflect_spot(double buffer, const Vector3& target) const {
  const double above = target.z() - outlets_.height(), height = std::max(0.0, above);
  if (above >= 0.0 && height >= buffer) return target;
  const double rim_clearance = std::sqrt(buffer * buffer - height * height);
  const Outlet& outlet = outlets_.nearest(target);
  const Vector3 place = target - outlet.centre, inside = outlet.hole->keep_inside(rim_clearance, place);
  if (inside == place) return target;
  return {outlet.centre.x() + inside.x(), outlet.centre.y() + inside.y(), target.z()};
}

std::optional<WallOnPath> BasePlate::meet(const Vector3& from, const Vector3& to) const {
  const auto share = outlets_.passed_at(from, to);
  if (!share) return std::nullopt;
  const Vector3 passed = from + *share * (to - from);
  if (outlets_.nearest(passed).distance(passed) <= 0.0) return std::nullopt;
  return WallOnPath{*share, {0.0, 0.0, from.z() < outlets_.height() ? -1.0 : 1.0}};
}

bool BasePlate::may_have_left_to(const Vector3& centre) const {
  return outlets_.nearest(centre).distance(centre) <= std::max(0.0, outlets_.height() - centre.z());
}

}  // namespace spot
