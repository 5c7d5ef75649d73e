// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/repeated_solid.hpp"

#include <cmath>
#include <optional>
#include <typeinfo>

#include "geometry/plane.hpp"
#include "spot/base/errors.hpp"

namespace spot {

namespace {

/// Of a period: places closer than this are the same.
constexpr double tolerance = 1e-9;

/// Is it the same a period farther on?
bool is_unchanged(const Surface& surface, int axis, double period) {
  const auto moved = surface.moved(period * Vector3::Unit(axis));
  const auto before = surface.numbers(period), after = moved->numbers(period);
  for (std::size_t k = 0; k < before.size(); ++k)
    if (std::abs(before[k] - after[k]) > tolerance * period) return false;
  return true;
}

bool is_unchanged(const Solid& solid, int axis, double period) {
  if (solid.kind() == Solid::Kind::side) return is_unchanged(*solid.surface(), axis, period);
  for (const Solid& part : solid.parts())
    if (!is_unchanged(part, axis, period)) return false;
  return true;
}

Solid moved(const Solid& solid, const Vector3& by) {
  if (solid.kind() == Solid::Kind::side) return Solid(solid.surface()->moved(by), solid.inner());
  const bool together = solid.kind() == Solid::Kind::union_of;
  Solid all = moved(solid.parts()[0], by);
  for (std::size_t k = 1; k < solid.parts().size(); ++k) {
    const Solid part = moved(solid.parts()[k], by);
    all = together ? all | part : all & part;
  }
  return all;
}

/// Is this the side of a plane across the axis that has all of the cell in it?
bool holds_cell(const Solid& side, int axis, const Periodic& periodic) {
  const auto* plane = dynamic_cast<const Plane*>(side.surface().get());
  if (!plane || plane->slant(Vector3::Unit(axis)) != 1.0) return false;
  const double slack = tolerance * periodic.length(axis), sign = side.inner() ? 1.0 : -1.0;
  const auto inside = [&](double at) { return sign * plane->depth(at * Vector3::Unit(axis)) >= -slack; };
  return inside(periodic.low(axis)) && inside(periodic.high(axis));
}

/// Without planes that only end it where the cell ends, or beyond; nothing if it is bounded by no other.
std::optional<Solid> without_ends(const Solid& solid, int axis, const Periodic& periodic) {
  if (solid.kind() == Solid::Kind::side) {
    if (holds_cell(solid, axis, periodic)) return std::nullopt;
    return solid;
  }
  const bool together = solid.kind() == Solid::Kind::union_of;
  std::optional<Solid> all;
  for (const Solid& each : solid.parts()) {
    const auto part = without_ends(each, axis, periodic);
    if (!part && together) return std::nullopt;
    if (part) all = !all ? *part : together ? *all | *part : *all & *part;
  }
  return all;
}

Solid repeated_along(int axis, const Solid& shape, double low, double high, const Periodic& periodic) {
  const double period = periodic.length(axis), slack = tolerance * period;
  const auto endless = without_ends(shape, axis, periodic);
  if (endless && is_unchanged(*endless, axis, period)) return *endless;
  if (low >= periodic.low(axis) - slack && high <= periodic.high(axis) + slack) {
    const Vector3 on = period * Vector3::Unit(axis);
    return shape | moved(shape, on) | moved(shape, -on);
  }
  const char name = "xy"[axis];
  throw InvalidContainer(message("space repeats along ", name, ", from ", periodic.low(axis), " to ",
                                 periodic.high(axis), ", but this shape, from ", low, " to ", high,
                                 ", neither lies between these nor goes through, from end to end, without a change "
                                 "along ",
                                 name));
}

}  // namespace

Solid repeated(const Solid& shape, const Vector3& low, const Vector3& high, const Periodic& periodic) {
  Solid all = shape;
  for (int axis = 0; axis < 2; ++axis)
    if (periodic.along(axis)) all = repeated_along(axis, all, low[axis], high[axis], periodic);
  return all;
}

}  // namespace spot
