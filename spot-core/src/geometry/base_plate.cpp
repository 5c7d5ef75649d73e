// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/base_plate.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/length.hpp"

namespace spot {

BasePlate::BasePlate(const Orifice& orifice) : orifice_(orifice) {}

WallContact BasePlate::nearest(const Vector3& centre) const {
  const double dx = centre.x() - orifice_.centre.x();
  const double dy = centre.y() - orifice_.centre.y();
  const double height = centre.z() - orifice_.centre.z();
  const double from_axis = length(dx, dy);
  if (from_axis >= orifice_.radius) return {std::abs(height), {0.0, 0.0, height < 0.0 ? -1.0 : 1.0}};
  if (from_axis == 0.0) return {length(orifice_.radius, height), {0.0, 0.0, 1.0}};
  const double to_rim = orifice_.radius - from_axis;
  const double distance = length(to_rim, height);
  return {distance, {-dx / from_axis * to_rim / distance, -dy / from_axis * to_rim / distance, height / distance}};
}

Vector3 BasePlate::reflect_spot(double buffer, const Vector3& target) const {
  const double above = target.z() - orifice_.centre.z(), height = std::max(0.0, above);
  if (above >= 0.0 && height >= buffer) return target;
  const double rim_clearance = std::sqrt(buffer * buffer - height * height);
  return orifice_.keep_within(std::max(0.0, orifice_.radius - rim_clearance), target);
}

std::optional<WallOnPath> BasePlate::meet(const Vector3& from, const Vector3& to) const {
  const auto share = orifice_.passed_at(from, to);
  if (!share) return std::nullopt;
  const Vector3 passed = from + *share * (to - from) - orifice_.centre;
  if (length(passed.x(), passed.y()) <= orifice_.radius) return std::nullopt;
  return WallOnPath{*share, {0.0, 0.0, from.z() < orifice_.centre.z() ? -1.0 : 1.0}};
}

bool BasePlate::may_have_left_to(const Vector3& centre) const {
  const double from_axis = length(centre.x() - orifice_.centre.x(), centre.y() - orifice_.centre.y());
  return from_axis <= orifice_.radius + std::max(0.0, orifice_.centre.z() - centre.z());
}

}  // namespace spot
