// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/packing/wall_marks.hpp"

#include <array>
#include <cmath>

#include "packing/wrapped_integers.hpp"
#include "spot/base/memory.hpp"

namespace spot {

namespace {

/// With more axis planes than bits for them in near_wall_, they are asked as all other walls are.
constexpr std::size_t most_planes = 7;
constexpr std::uint8_t near_other_wall = 1u << most_planes;

}  // namespace

void WallMarks::find_planes(const Container& container) {
  constexpr std::array<std::int32_t Point::*, 3> axes = {&Point::x, &Point::y, &Point::z};
  const CellLattice& lattice = cells_.lattice();
  planes_.clear();
  if (container.axis_planes().size() > most_planes) return;
  for (const AxisPlane& plane : container.axis_planes()) {
    planes_.push_back(
        {axes[static_cast<std::size_t>(plane.axis)], plane.at, lattice.low()[plane.axis], plane.grains_below, 0});
    planes_.back().largest_touch = touching(planes_.back(), 0.5 * lattice.diameter());
  }
}

/// Where grains of this radius that touch a plane have their centres, in wrapped quanta from low.
std::int32_t WallMarks::touching(const TouchingPlane& plane, double radius) const {
  const double place = plane.at + (plane.grains_below ? -radius : radius) - plane.low;
  return wrap(std::llrint(place / cells_.lattice().quantum().length()));
}

/// The walls that are not in planes_.
void WallMarks::other_contacts(const Container& container, const Vector3& centre, double reach,
                               WallContacts& contacts) const {
  if (planes_.empty())
    container.contacts(centre, reach, contacts);
  else
    container.other_contacts(centre, reach, contacts);
}

std::uint8_t WallMarks::mark_of(std::uint32_t slot, const Container& container) const {
  const CellLattice& lattice = cells_.lattice();
  const Vector3 at = lattice.low() + cells_.from_low(cells_.references[slot], cells_.cell_of(slot));
  const double reach = 0.5 * (lattice.diameter() + lattice.skin());
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
  return mark;
}

void WallMarks::mark(std::uint32_t slot, std::uint8_t mark) {
  near_wall_[slot] = mark;
  if (mark != 0) cell_near_wall_[cells_.cell_of(slot)] = 1;
}

void WallMarks::mark_all(const Container& container) {
  find_planes(container);
  cells_.visit_own([&](std::uint32_t slot) { mark(slot, mark_of(slot, container)); });
}

void WallMarks::push_off_planes(std::uint32_t slot, float strength, Point& push) const {
  for (std::size_t p = 0; p < planes_.size(); ++p) {
    if ((near_wall_[slot] >> p & 1u) == 0) continue;
    const TouchingPlane& plane = planes_[p];
    const std::int32_t beyond = minus(cells_.points[slot].*plane.axis,
                                      cells_.unequal() ? touching(plane, cells_.radius(slot)) : plane.largest_touch);
    if (plane.grains_below ? beyond > 0 : beyond < 0)
      push.*plane.axis -= static_cast<std::int32_t>(strength * static_cast<float>(beyond));
  }
}

void WallMarks::push_off_others(std::uint32_t slot, double strength, const Container& container, Point& push) const {
  if ((near_wall_[slot] & near_other_wall) == 0) return;
  const double radius = cells_.radius(slot);
  WallContacts contacts;
  other_contacts(container, cells_.position(slot), radius, contacts);
  for (const WallContact& contact : contacts)
    add(push, cells_.lattice().wrapped(strength * (radius - contact.distance) * contact.normal));
}

void WallMarks::renumber(const std::vector<std::uint32_t>& now, std::size_t slots) {
  const AlignedVector<std::uint8_t> old = std::move(near_wall_);
  near_wall_.assign(slots, 0);
  for (std::size_t slot = 0; slot < now.size(); ++slot) near_wall_[now[slot]] = old[slot];
  if (now.empty()) cell_near_wall_.assign(cells_.count(), 0);
}

std::size_t WallMarks::memory() const { return bytes_in(planes_, near_wall_, cell_near_wall_); }

}  // namespace spot
