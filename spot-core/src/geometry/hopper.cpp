// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/hopper.hpp"

#include <algorithm>
#include <cmath>

#include "spot/base/elementary.hpp"

namespace spot {

namespace {

/// Walls are looked for so far from the outlet's centre, in its radii: a hopper that widens faster is as good as flat.
constexpr double farthest = 30.0;

/// Walls are straight, begin at the rim and are alike on all sides within this, in radii of the outlet, and in slopes.
constexpr double straight = 0.02, at_rim = 0.05, alike = 0.02;

/// How far the wall is from the outlet's axis this much above it; none beyond the farthest.
std::optional<double> width_at(const Container& container, const Outlet& outlet, double height,
                               const Vector3& outwards) {
  const double reach = farthest * outlet.hole->widest_radius();
  const Vector3 from = outlet.centre + height * Vector3::UnitZ();
  const auto wall = container.first_wall(from, from + reach * outwards);
  if (!wall) return std::nullopt;
  return wall->share * reach;
}

/// By how much the wall on one side recedes for each length of height.
std::optional<double> slope_on(const Container& container, const Outlet& outlet, int axis, double side) {
  const double radius = outlet.hole->widest_radius();
  const Vector3 outwards = side * Vector3::Unit(axis);
  const auto low = width_at(container, outlet, 0.25 * radius, outwards),
             middle = width_at(container, outlet, 0.5 * radius, outwards),
             high = width_at(container, outlet, radius, outwards);
  if (!low || !middle || !high) return std::nullopt;
  const double slope = (*high - *low) / (0.75 * radius), rim = *low - 0.25 * radius * slope;
  const bool straight_up = std::abs(rim + 0.5 * radius * slope - *middle) < straight * radius;
  const bool from_rim = std::abs(rim - outlet.hole->half_width(axis)) < at_rim * radius;
  if (!straight_up || !from_rim || slope < -alike) return std::nullopt;
  return std::max(0.0, slope);
}

}  // namespace

std::optional<double> hopper_slope(const Container& container, const Outlet& outlet) {
  const double smaller = std::min(outlet.hole->half_width(0), outlet.hole->half_width(1));
  std::optional<double> slope;
  for (int axis = 0; axis < 2; ++axis) {
    if (outlet.hole->half_width(axis) > smaller) continue;  // the ends of a slot
    for (const double side : {-1.0, 1.0}) {
      const auto here = slope_on(container, outlet, axis, side);
      if (!here || (slope && std::abs(*here - *slope) > alike * (1.0 + *slope))) return std::nullopt;
      if (!slope) slope = here;
    }
  }
  return slope;
}

double hopper_factor(double tan_half_angle, double tan_material_angle) {
  constexpr double exponent = -0.35;
  const double product = tan_half_angle * tan_material_angle;
  return product < 1.0 ? pow(product, exponent) : 1.0;
}

double tangent(double degrees) {
  const double turns = degrees / 360.0;
  return sin_of_turns(turns) / cos_of_turns(turns);
}

}  // namespace spot
