// SPDX-License-Identifier: GPL-2.0-only
#include "lammps_headers.h"

#include "region_container.h"

#include "region.h"
#include "spot/base/errors.hpp"

#include <cmath>
#include <string>

using spot::Vector3;

namespace LAMMPS_NS {

RegionContainer::RegionContainer(Region *region, Domain &domain, const spot::Orifice &orifice,
                                 const spot::SpotBuffers &buffers)
    : BodyContainer(orifice, buffers), region_(region), orifice_(orifice), parts_(region, domain, orifice) {
  region_->prematch();
  require_mouth();
}

bool RegionContainer::contains(const Vector3 &c) const {
  if (c.z() < orifice_.centre.z()) return false;
  // Region::match() would say that everything is inside a region with an open face.
  return (region_->inside(c.x(), c.y(), c.z()) != 0) == (region_->interior != 0);
}

void RegionContainer::contacts(const Vector3 &c, double reach, spot::WallContacts &contacts) const {
  contacts.clear();
  if (c.z() < orifice_.centre.z()) return;
  Vector3 place = c;
  for (int attempt = 0; attempt < 2; ++attempt) {
    const int n = region_->surface(place.x(), place.y(), place.z(), reach);
    bool on_wall = false;
    for (int i = 0; i < n; ++i) {
      // The distance from the vector: `r` is wrong for unions seen from outside.
      const Region::Contact &contact = region_->contact[i];
      const Vector3 from_wall(contact.delx, contact.dely, contact.delz);
      const double distance = from_wall.norm();
      on_wall = on_wall || distance == 0.0;
      if (distance > 0.0 && distance < reach) contacts.add({distance, from_wall / distance});
    }
    if (!on_wall || attempt == 1) return;
    // On a wall LAMMPS has no direction for it; beside it, it has.
    place = beside_walls(c, reach);
    contacts.clear();
  }
}

/// A place inside, next to one that is on a wall, that is on none; or the place itself, in an edge too sharp for that.
Vector3 RegionContainer::beside_walls(const Vector3 &place, double reach) const {
  for (int i = -2; i <= 2; ++i)
    for (int j = -2; j <= 2; ++j)
      for (int k = -2; k <= 2; ++k) {
        // Odd directions, so that few walls are along one.
        const Vector3 beside = place + 1e-6 * reach * Vector3(i + 0.13, j + 0.29, k + 0.37);
        if (!contains(beside)) continue;
        const auto wall = nearest_wall(beside, reach);
        if (!wall || wall->distance > 1e-9 * reach) return beside;
      }
  return place;
}

std::optional<spot::WallContact> RegionContainer::nearest_wall(const Vector3 &place, double reach) const {
  std::optional<spot::WallContact> nearest;
  const int n = region_->surface(place.x(), place.y(), place.z(), reach);
  for (int i = 0; i < n; ++i) {
    const Region::Contact &contact = region_->contact[i];
    const Vector3 from_wall(contact.delx, contact.dely, contact.delz);
    const double distance = from_wall.norm();
    if (distance < reach && !(nearest && nearest->distance <= distance))
      nearest = {distance, distance > 0.0 ? Vector3(from_wall / distance) : Vector3::Zero()};
  }
  return nearest;
}

/// Where the region is asked from: its base may be off the height of the orifice by rounding.
double RegionContainer::entrance_height() const { return orifice_.centre.z() + 1e-6 * orifice_.radius; }

std::optional<spot::WallOnPath> RegionContainer::first_wall_above(const Vector3 &from, const Vector3 &to) const {
  const auto raised = [&](const Vector3 &at) { return Vector3(at.x(), at.y(), std::max(at.z(), entrance_height())); };
  return parts_.first_wall(raised(from), raised(to));
}

/* ----------------------------------------------------------------------
   is there an opening where the orifice is?
------------------------------------------------------------------------- */

/// Of a place just above the height of the orifice.
bool RegionContainer::opens_below(const Vector3 &place) const {
  const double height = place.z() - orifice_.centre.z();
  const Vector3 below = place - Vector3(0.0, 0.0, 2.0 * height);
  if ((region_->inside(below.x(), below.y(), below.z()) != 0) == (region_->interior != 0))
    return !parts_.first_wall(place, below);
  return region_->openflag != 0 && !nearest_wall(place, 4.0 * height);
}

void RegionContainer::require_mouth() const {
  const double radius = orifice_.radius;
  const auto place = [&](double share, int turn) {  // turn: 1/64 of a whole one
    const double angle = 2.0 * 3.14159265358979323846 / 64.0 * turn, r = share * radius;
    return Vector3(orifice_.centre.x() + r * std::cos(angle), orifice_.centre.y() + r * std::sin(angle),
                   entrance_height());
  };
  int outside = 0, walled = 0, open = 0;
  std::optional<Vector3> closed;
  for (const double share : {0.0, 0.25, 0.5, 0.75, 0.9, 0.99, 1.0 - 1e-6})
    for (int turn = 0; turn < 64; ++turn) {
      const Vector3 at = place(share, turn), above = at + Vector3(0.0, 0.0, 0.1 * radius);
      // At the rim the sides of a funnel are close, and walls may lean over the orifice.
      const bool at_rim = share > 0.995, near_rim = share > 0.895;
      if (!contains(at))
        ++outside;
      else if (!at_rim && (!opens_below(at) || (!near_rim && parts_.first_wall(at, above))))
        ++walled;
      else {
        open += !near_rim;
        continue;
      }
      if (!closed) closed = at;
    }
  const Vector3 &c = orifice_.centre;
  const std::string orifice =
      spot::message("the orifice of radius ", radius, " at (", c.x(), ", ", c.y(), ", ", c.z(), ")");
  const std::string region = spot::message("region '", region_->id, "'");
  if (open == 0 && walled == 0) throw spot::InvalidContainer(orifice + " is outside " + region);
  if (open == 0)
    throw spot::InvalidContainer(spot::message("a wall of ", region, " lies across ", orifice,
                                               ": open the region there, ", way_to_write_mouth(orifice_)));
  if (closed)
    throw spot::InvalidContainer(spot::message(orifice, " reaches beyond the mouth of ", region, ": at (", closed->x(),
                                               ", ", closed->y(), ", ", closed->z(), ") there is a wall"));
  constexpr double widest = 1.5;
  bool open_all_around = true;
  for (int turn = 0; turn < 64; ++turn) {
    const Vector3 at = place(widest, turn);
    open_all_around = open_all_around && contains(at) && opens_below(at);
  }
  if (open_all_around)
    throw spot::InvalidContainer(spot::message("the mouth of ", region, " is wider than ", orifice,
                                               ": it has no base around the orifice, nowhere at a radius of ",
                                               widest * radius));
}

}  // namespace LAMMPS_NS
