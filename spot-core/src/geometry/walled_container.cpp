// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/walled_container.hpp"

#include <algorithm>
#include <cmath>

#include "spot/base/errors.hpp"

namespace spot {

WalledContainer::WalledContainer(const Orifice& orifice) : orifice_(orifice) {
  if (!(orifice.radius > 0.0) || !std::isfinite(orifice.radius) || !orifice.centre.allFinite())
    throw InvalidContainer(message("orifice radius is ", orifice.radius, " but must be positive and finite"));
}

void WalledContainer::add(std::unique_ptr<Wall> wall, double spot_buffer) {
  if (!(spot_buffer >= 0.0) || !std::isfinite(spot_buffer))
    throw InvalidContainer(message("spot buffer is ", spot_buffer, " but must be zero or positive"));
  if (const auto plane = wall->axis_plane()) axis_planes_.push_back(*plane);
  walls_.push_back({std::move(wall), spot_buffer});
}

bool WalledContainer::contains(const Vector3& centre) const {
  return std::all_of(walls_.begin(), walls_.end(),
                     [&](const Bounded& b) { return b.wall->nearest(centre).distance >= 0.0; }) &&
         centre.z() >= orifice_.centre.z();
}

bool WalledContainer::may_have_left_to(const Vector3& centre) const {
  return std::all_of(walls_.begin(), walls_.end(), [&](const Bounded& b) { return b.wall->may_have_left_to(centre); });
}

void WalledContainer::contacts(const Vector3& centre, double reach, WallContacts& contacts) const {
  contacts.clear();
  for (const Bounded& b : walls_) {
    const WallContact contact = b.wall->nearest(centre);
    if (contact.distance < reach) contacts.add(contact);
  }
}

void WalledContainer::other_contacts(const Vector3& centre, double reach, WallContacts& contacts) const {
  contacts.clear();
  for (const Bounded& b : walls_) {
    if (b.wall->axis_plane()) continue;
    const WallContact contact = b.wall->nearest(centre);
    if (contact.distance < reach) contacts.add(contact);
  }
}

std::optional<WallOnPath> WalledContainer::first_wall(const Vector3& from, const Vector3& to) const {
  const bool rises = from.z() < orifice_.centre.z();
  const auto passed = orifice_.passed_at(from, to);
  if (rises && !passed) return std::nullopt;
  const double begin = rises ? *passed : 0.0, end = passed && !rises ? *passed : 1.0;
  std::optional<WallOnPath> first;
  for (const Bounded& b : walls_) {
    auto wall = b.wall->meet(from, to);
    // Planes go on below the orifice, where they are no walls.
    if (wall && wall->share < begin && (wall = b.wall->meet(from + begin * (to - from), to)))
      wall->share = begin + wall->share * (1.0 - begin);
    if (wall && wall->share <= end && (!first || wall->share < first->share)) first = wall;
  }
  return first;
}

std::optional<Vector3> WalledContainer::reflect_spot(const Vector3& start, const Vector3& target) const {
  // A reflection can lead into the next wall's buffer; in a corner or a narrow gap a few rounds settle it.
  constexpr int rounds = 8;
  Vector3 position = target;
  for (int round = 0; round < rounds; ++round) {
    const Vector3 before = position;
    for (const Bounded& b : walls_) position = b.wall->reflect_spot(b.spot_buffer, position);
    if (position != before) continue;
    if (first_wall(start, position)) break;
    return position;
  }
  return std::nullopt;
}

}  // namespace spot
