// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/walled_container.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/cells_on_path.hpp"
#include "spot/base/errors.hpp"

namespace spot {

void WalledContainer::add(std::unique_ptr<Wall> wall, double spot_buffer) {
  if (!(spot_buffer >= 0.0) || !std::isfinite(spot_buffer))
    throw InvalidContainer(message("spot buffer is ", spot_buffer, " but must be zero or positive"));
  if (const auto plane = wall->axis_plane()) {
    require_no_period_across(*plane);
    axis_planes_.push_back(*plane);
  }
  walls_.push_back({std::move(wall), spot_buffer});
}

void WalledContainer::require_no_period_across(const AxisPlane& plane) const {
  if (periodic_.along(plane.axis))
    throw InvalidContainer(message("a wall across ", "xyz"[plane.axis], " at ", plane.at,
                                   " stands in the way of a container that repeats along that axis"));
}

void WalledContainer::repeat(const Periodic& periodic) {
  outlets_.require_within(periodic);
  periodic_ = periodic;
  for (const AxisPlane& plane : axis_planes_) require_no_period_across(plane);
}

bool WalledContainer::contains(const Vector3& place) const {
  const Vector3 centre = periodic_.any() ? periodic_.wrap(place) : place;
  return std::all_of(walls_.begin(), walls_.end(),
                     [&](const Bounded& b) { return b.wall->nearest(centre).distance >= 0.0; }) &&
         centre.z() >= outlets_.height();
}

bool WalledContainer::may_have_left_to(const Vector3& place) const {
  const auto may_have_left = [&](const Vector3& centre) {
    return std::all_of(walls_.begin(), walls_.end(),
                       [&](const Bounded& b) { return b.wall->may_have_left_to(centre); });
  };
  return periodic_.any() ? any_image_at_outlets(outlets_, periodic_, place, may_have_left) : may_have_left(place);
}

void WalledContainer::contacts(const Vector3& place, double reach, WallContacts& contacts) const {
  const Vector3 centre = periodic_.any() ? periodic_.wrap(place) : place;
  contacts.clear();
  for (const Bounded& b : walls_) {
    const WallContact contact = b.wall->nearest(centre);
    if (contact.distance < reach) contacts.add(contact);
  }
}

void WalledContainer::other_contacts(const Vector3& place, double reach, WallContacts& contacts) const {
  const Vector3 centre = periodic_.any() ? periodic_.wrap(place) : place;
  contacts.clear();
  for (const Bounded& b : walls_) {
    if (b.wall->axis_plane()) continue;
    const WallContact contact = b.wall->nearest(centre);
    if (contact.distance < reach) contacts.add(contact);
  }
}

std::optional<WallOnPath> WalledContainer::first_wall(const Vector3& from, const Vector3& to) const {
  if (!periodic_.any()) return first_wall_in_cell(from, to);
  return first_in_cells(periodic_, from, to,
                        [this](const Vector3& first, const Vector3& last) { return first_wall_in_cell(first, last); });
}

/// Of a path in the cell. Walls go on beyond it.
std::optional<WallOnPath> WalledContainer::first_wall_in_cell(const Vector3& from, const Vector3& to) const {
  const bool rises = from.z() < outlets_.height();
  const auto passed = outlets_.passed_at(from, to);
  if (rises && !passed) return std::nullopt;
  const double begin = rises ? *passed : 0.0, end = passed && !rises ? *passed : 1.0;
  std::optional<WallOnPath> first;
  for (const Bounded& b : walls_) {
    auto wall = b.wall->meet(from, to);
    // Planes go on below the outlets, where they are no walls.
    if (wall && wall->share < begin && (wall = b.wall->meet(from + begin * (to - from), to)))
      wall->share = begin + wall->share * (1.0 - begin);
    if (wall && wall->share <= end && (!first || wall->share < first->share)) first = wall;
  }
  return first;
}

std::optional<Vector3> WalledContainer::reflect_spot(const Vector3& start, const Vector3& target) const {
  if (!periodic_.any()) return reflect_in_cell(start, target);
  const Vector3 into_cell = periodic_.wrap(target) - target;
  auto end = reflect_in_cell(start + into_cell, target + into_cell);
  if (end) *end -= into_cell;
  return end;
}

std::optional<Vector3> WalledContainer::reflect_in_cell(const Vector3& start, const Vector3& target) const {
  // A reflection can lead into the next wall's buffer; in a corner or a narrow gap a few rounds settle it.
  constexpr int rounds = 8;
  Vector3 position = target;
  for (int round = 0; round < rounds; ++round) {
    const Vector3 before = position;
    for (const Bounded& b : walls_) {
      if (b.wall->curved() && b.wall->nearest(position).distance < b.spot_buffer) return std::nullopt;
      position = b.wall->reflect_spot(b.spot_buffer, position);
    }
    if (position != before) continue;
    if (first_wall(start, position)) break;
    return position;
  }
  return std::nullopt;
}

}  // namespace spot
