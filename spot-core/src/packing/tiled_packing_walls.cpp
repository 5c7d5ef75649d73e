// SPDX-License-Identifier: GPL-2.0-or-later
#include <cmath>

#include "packing/wrapped_integers.hpp"
#include "spot/packing/tiled_packing.hpp"

namespace spot {

namespace {

/// With more axis planes than bits for them in near_wall_, they are asked as all other walls are.
constexpr std::size_t most_planes = 7;
constexpr std::uint8_t near_other_wall = 1u << most_planes;

}  // namespace

void TiledPacking::find_planes(const Container& container) {
  constexpr std::array<std::int32_t Point::*, 3> axes = {&Point::x, &Point::y, &Point::z};
  planes_.clear();
  if (container.axis_planes().size() > most_planes) return;
  for (const AxisPlane& plane : container.axis_planes()) {
    const double touching = plane.at + (plane.grains_below ? -0.5 : 0.5) * diameter_ - low_[plane.axis];
    planes_.push_back({axes[static_cast<std::size_t>(plane.axis)], wrap(std::llrint(touching / quantum_.length())),
                       plane.grains_below});
  }
}

/// The walls that are not in planes_.
void TiledPacking::other_contacts(const Container& container, const Vector3& centre, double reach,
                                  WallContacts& contacts) const {
  if (planes_.empty())
    container.contacts(centre, reach, contacts);
  else
    container.other_contacts(centre, reach, contacts);
}

void TiledPacking::mark_near_wall(std::uint32_t slot, const Container& container) {
  // Where it was listed: the mark holds for as long as the list.
  const Vector3 at = low_ + from_low(references_[slot], slot / capacity_);
  const double reach = 0.5 * (diameter_ + skin_);
  std::uint8_t mark = 0;
  for (std::size_t k = 0; k < planes_.size(); ++k) {
    // Not in wrapped quanta: far walls would seem near.
    const AxisPlane& plane = container.axis_planes()[k];
    if ((plane.grains_below ? plane.at - at[plane.axis] : at[plane.axis] - plane.at) < reach)
      mark |= static_cast<std::uint8_t>(1u << k);
  }
  WallContacts contacts;
  other_contacts(container, at, reach, contacts);
  if (contacts.begin() != contacts.end()) mark |= near_other_wall;
  near_wall_[slot] = mark;
  if (mark != 0) cell_near_wall_[slot / capacity_] = 1;
}

void TiledPacking::mark_near_walls(const Container& container) {
  find_planes(container);
  for (std::uint32_t slot = first_owned() * capacity_; slot < last_owned() * capacity_; ++slot)
    if (ids_[slot] >= 0) mark_near_wall(slot, container);
}

void TiledPacking::push_off_planes(Task& task, float strength) const {
  for (const std::uint32_t k : task.walled) {
    const std::uint32_t slot = task.active[k];
    for (std::size_t p = 0; p < planes_.size(); ++p) {
      if ((near_wall_[slot] >> p & 1u) == 0) continue;
      const TouchingPlane& plane = planes_[p];
      const std::int32_t beyond = minus(points_[slot].*plane.axis, plane.at);
      if (plane.grains_below ? beyond > 0 : beyond < 0)
        task.pushes[k].*plane.axis -= static_cast<std::int32_t>(strength * static_cast<float>(beyond));
    }
  }
}

void TiledPacking::push_off_other_walls(Task& task, double strength, const Container& container) const {
  const double radius = 0.5 * diameter_;
  WallContacts contacts;
  for (const std::uint32_t k : task.walled) {
    if ((near_wall_[task.active[k]] & near_other_wall) == 0) continue;
    other_contacts(container, position(task.active[k]), radius, contacts);
    for (const WallContact& contact : contacts)
      push(task.pushes[k], strength * (radius - contact.distance) * contact.normal);
  }
}

}  // namespace spot
