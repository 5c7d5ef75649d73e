// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/round_hole.hpp"

#include <algorithm>

#include "geometry/directions.hpp"
#include "geometry/length.hpp"
#include "spot/base/elementary.hpp"
#include "spot/geometry/shapes.hpp"

namespace spot {

RoundHole::RoundHole(double radius) : radius_(radius) { require_positive(radius, "the radius of the orifice"); }

std::string RoundHole::name() const { return message("orifice of radius ", radius_); }

double RoundHole::distance(const Vector3& place) const { return length(place.x(), place.y()) - radius_; }

Vector3 RoundHole::to_rim(const Vector3& place) const {
  const double from_axis = length(place.x(), place.y());
  if (from_axis == 0.0) return Vector3::Zero();
  return {place.x() / from_axis, place.y() / from_axis, 0.0};
}

Vector3 RoundHole::keep_inside(double margin, const Vector3& place) const {
  const double limit = std::max(0.0, radius_ - margin), from_axis = length(place.x(), place.y());
  if (from_axis <= limit) return place;
  const double scale = std::max(0.0, 2.0 * limit - from_axis) / from_axis;
  return {scale * place.x(), scale * place.y(), place.z()};
}

Vector3 RoundHole::point(double margin, double first, double second) const {
  const double from_axis = std::max(0.0, radius_ - margin) * std::sqrt(first);
  return {from_axis * cos_of_turns(second), from_axis * sin_of_turns(second), 0.0};
}

double RoundHole::farthest(const Vector3& place) const { return length(place.x(), place.y()) + radius_; }

double RoundHole::discharge(const BeverlooLaw& law, double diameter) const {
  const double wide = 2.0 * radius_ - law.margin * diameter;
  return wide > 0.0 ? law.round * wide * wide * std::sqrt(wide) : 0.0;
}

Solid RoundHole::column(const Vector3& centre) const { return cylinder(centre, Vector3::UnitZ(), radius_); }

}  // namespace spot
