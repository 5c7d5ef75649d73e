// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/relaxation/bearing.hpp"

#include <algorithm>
#include <cmath>

#include "packing/wrapped_integers.hpp"

namespace spot {

namespace {

// All in diameters.

/// A grain of the packing hangs if it finds nobody lower than itself by the second, no farther away than the first.
constexpr double reach_of_support = 1.5, least_drop = 0.25;

/// Walls bear a grain from so far away, if their normal points upwards by the second; by the third, they are a floor.
constexpr double wall_reach = 1.0, least_upwards = 0.1, flat = 0.99;

/// Gap at which two grains bear on each other.
constexpr double contact_gap = 0.01;

/// Of an overlap, what a grain goes off one that bears it, or off a wall.
constexpr double strength = 0.5;

}  // namespace

bool Bearing::is_borne(std::uint32_t slot) const {
  const Point& own = cells_.points[slot];
  for (const std::uint32_t j : packing_.lists().of(slot)) {
    const Point& other = cells_.points[j];
    if (other.state == Point::falling) continue;
    const double per_diameter = packing_.quantum().length() / (cells_.radius(slot) + cells_.radius(j));
    if (minus(own.z, other.z) * per_diameter < least_drop) continue;
    if (squared_distance(own, other) * square(per_diameter) <= square(reach_of_support)) return true;
  }
  const Vector3 place = cells_.position(slot);
  const double diameter = 2.0 * cells_.radius(slot);
  return is_over_outlet(place, wall_reach * diameter) || is_near_floor_or_slope(place, wall_reach * diameter);
}

bool Bearing::is_over_outlet(const Vector3& place, double reach) const {
  const double height = place.z() - container_.outlets().height();
  return height < 0.0 || (height <= reach && container_.is_over_outlet(place));
}

bool Bearing::is_near_floor_or_slope(const Vector3& place, double reach) const {
  WallContacts contacts;
  container_.contacts(place, reach, contacts);
  return std::any_of(contacts.begin(), contacts.end(),
                     [](const WallContact& contact) { return contact.normal.z() >= least_upwards; });
}

bool Bearing::is_on_floor(std::uint32_t slot) const {
  const Vector3 place = cells_.position(slot);
  const double diameter = 2.0 * cells_.radius(slot);
  if (is_over_outlet(place, 0.5 * diameter)) return true;
  WallContacts walls;
  if (packing_.walls().near_wall(slot)) container_.contacts(place, (0.5 + contact_gap) * diameter, walls);
  return std::any_of(walls.begin(), walls.end(), [](const WallContact& wall) { return wall.normal.z() > flat; });
}

double Bearing::depth_in_outlet(std::uint32_t slot) const {
  const Vector3 place = cells_.position(slot);
  const double diameter = 2.0 * cells_.radius(slot);
  const double height = (place.z() - container_.outlets().height()) / diameter;
  return height >= 0.0 && is_over_outlet(place, 0.5 * diameter) ? 0.5 - height : 0.0;
}

std::vector<Vector3> Bearing::contact_normals(std::uint32_t slot, std::int32_t least) const {
  std::vector<Vector3> normals;
  const Point& own = cells_.points[slot];
  for (const std::uint32_t j : packing_.lists().of(slot)) {
    const Point& other = cells_.points[j];
    const bool bears = other.state != Point::falling && (other.state != Point::resting || least == Point::resting);
    if (!bears || squared_distance(own, other) > square((1.0 + contact_gap) * cells_.touching_distance(slot, j)))
      continue;
    const Point by = minus(own, other);
    const Vector3 normal = Vector3(by.x, by.y, by.z);
    if (normal.squaredNorm() > 0.0) normals.push_back(normal.normalized());
  }
  WallContacts walls;
  if (packing_.walls().near_wall(slot))
    container_.contacts(cells_.position(slot), (0.5 + contact_gap) * (2.0 * cells_.radius(slot)), walls);
  for (const WallContact& wall : walls) normals.push_back(wall.normal);
  return normals;
}

double Bearing::push_off(std::uint32_t slot, const Point& place, double in_contact, Point& push) const {
  double depth = 0.0;
  for (const std::uint32_t j : packing_.lists().of(slot)) {
    const Point& other = cells_.points[j];
    const double parted = (1.0 - in_contact) * cells_.touching_distance(slot, j);
    const double squared = squared_distance(place, other);
    if (squared >= square(parted)) continue;
    const Point by = minus(place, other);
    const bool comes_down = other.state == Point::falling || other.state == Point::resting;
    if (comes_down && (by.z < 0 || (by.z == 0 && cells_.ids[slot] < cells_.ids[j]))) continue;
    depth = std::max(depth, 1.0 - std::sqrt(squared) / parted);
    // Centres that coincide have no line between them.
    const double scale = squared > 0.0 ? strength * (parted / std::sqrt(squared) - 1.0) : 0.0;
    push.x = add(push.x, wrap(std::llrint(scale * by.x)));
    push.y = add(push.y, wrap(std::llrint(scale * by.y)));
    push.z = add(push.z, squared > 0.0 ? wrap(std::llrint(scale * by.z)) : wrap(std::llrint(strength * parted)));
  }
  const double radius = cells_.radius(slot);
  WallContacts walls;
  if (packing_.walls().near_wall(slot)) {
    const Vector3 at = cells_.lattice().low() + cells_.from_low(place, cells_.cell_of(slot));
    container_.contacts(at, radius, walls);
  }
  for (const WallContact& wall : walls) {
    const double overlap = radius - wall.distance;
    add(push, cells_.lattice().wrapped(strength * overlap * wall.normal));
    depth = std::max(depth, overlap / (2.0 * radius));
  }
  return depth;
}

}  // namespace spot
