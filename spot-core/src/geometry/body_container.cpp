// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/body_container.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/cells_on_path.hpp"
#include "spot/base/errors.hpp"

namespace spot {

namespace {

/// Spots on their way in are between the walls that begin at the rim, in a hopper, or over the base around it.
void require_room(const Outlet& outlet, double side_buffer) {
  const double half = outlet.hole->widest_radius();
  if (side_buffer < half) return;
  throw InvalidContainer(message("buffer of spots from side walls is ", side_buffer, " but must be below ", half,
                                 ", half the width of the ", outlet.name(), ": no spot fits into it"));
}

}  // namespace

BodyContainer::BodyContainer(const Outlets& outlets, const SpotBuffers& buffers, const Periodic& periodic)
    : outlets_(outlets), periodic_(periodic), buffers_(buffers), base_(outlets) {
  outlets_.require_within(periodic_);
  for (const Outlet& outlet : outlets_) require_room(outlet, buffers_.side);
}

std::optional<WallOnPath> BodyContainer::first_wall(const Vector3& from, const Vector3& to) const {
  if (!periodic_.any()) return first_wall_in_cell(from, to);
  return first_in_cells(periodic_, from, to,
                        [this](const Vector3& first, const Vector3& last) { return first_wall_in_cell(first, last); });
}

bool BodyContainer::meets_base(const Vector3& from, const Vector3& to) const {
  const auto meet = [this](const Vector3& first, const Vector3& last) { return base_.meet(first, last); };
  return (periodic_.any() ? first_in_cells(periodic_, from, to, meet) : meet(from, to)).has_value();
}

std::optional<WallOnPath> BodyContainer::first_wall_in_cell(const Vector3& from, const Vector3& to) const {
  const bool rises = from.z() < outlets_.height();
  const auto passed = outlets_.passed_at(from, to);
  if (rises && !passed) return std::nullopt;
  // Even where the body leads on below, nothing gets past their height beside the outlets.
  auto base = base_.meet(from, to);
  if (rises && base) return base;
  const double begin = rises ? *passed : 0.0, end = passed && !rises ? *passed : 1.0;
  auto wall = first_wall_above(from + begin * (to - from), from + end * (to - from));
  if (!wall) return base;
  wall->share = begin + wall->share * (end - begin);
  return wall;
}

std::optional<Vector3> BodyContainer::reflect_spot(const Vector3& start, const Vector3& target) const {
  if (!periodic_.any()) return reflect_in_cell(start, target);
  const Vector3 into_cell = periodic_.wrap(target) - target;
  auto end = reflect_in_cell(start + into_cell, target + into_cell);
  if (end) *end -= into_cell;
  return end;
}

/// Is this an upright wall that is curved? Spots would not stay uniform in front of it if it reflected them: a mirror
/// image in it is smaller or larger than what it shows. Walls that lean must reflect, or spots that only climb would
/// hardly come to those that move away from them. `place` is closer to the wall than `length`.
bool BodyContainer::is_curved_and_upright(const Vector3& place, const Vector3& normal, double length) const {
  constexpr double aside = 1e-3, alike = 1e-8;  // a wall with a radius of 1e4 lengths is flat
  if (std::abs(normal.z()) > alike) return false;
  const Vector3 along(-aside * length * normal.y(), aside * length * normal.x(), 0.0);
  for (const Vector3& beside : {Vector3(place + along), Vector3(place - along)})
    if (const auto wall = nearest_wall(beside, 2.0 * length); wall && (wall->normal - normal).norm() < alike)
      return false;
  return true;
}

std::optional<Vector3> BodyContainer::reflect_in_cell(const Vector3& start, const Vector3& target) const {
  constexpr int rounds = 8;
  // A mirror makes a step longer only by what the start is closer to the wall than the buffer.
  const double longest = (target - start).norm() + 2.0 * std::max(buffers_.side, buffers_.base);
  Vector3 position = target;
  for (int round = 0; round < rounds; ++round) {
    position = base_.reflect_spot(buffers_.base, position);
    if ((position - start).norm() > longest) break;
    if (meets_base(start, position)) break;
    if (const auto wall = first_wall(start, position)) {
      if (wall->normal.isZero()) break;
      const Vector3 met = start + wall->share * (position - start);
      const double inside = 1e-3 * longest;
      if (is_curved_and_upright(met + inside * wall->normal, wall->normal, 2.0 * inside)) break;
      const double behind = wall->normal.dot(met - position);
      position += 2.0 * (buffers_.side + behind) * wall->normal;
      continue;
    }
    if (position.z() <= outlets_.height()) return position;
    const auto close = nearest_wall(position, buffers_.side);
    if (!close) return position;
    if (is_curved_and_upright(position, close->normal, buffers_.side)) break;
    position += 2.0 * (buffers_.side - close->distance) * close->normal;
  }
  return std::nullopt;
}

}  // namespace spot
