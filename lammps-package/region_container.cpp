// SPDX-License-Identifier: GPL-2.0-only
#include "region_container.h"

#include <algorithm>

#include "lammps_headers.h"
#include "region.h"
#include "spot/errors.hpp"

using spot::Vector3;

namespace LAMMPS_NS {

RegionContainer::RegionContainer(Region *region, const spot::Orifice &orifice, const spot::SpotBuffers &buffers)
    : region_(region), orifice_(orifice), buffers_(buffers) {
  region_->prematch();
  const Vector3 entrance = orifice.centre + Vector3(0.0, 0.0, 1e-6 * orifice.radius);
  if (!contains(entrance))
    throw spot::InvalidContainer(spot::message("the orifice at (", entrance.x(), ", ", entrance.y(), ", ", entrance.z(),
                                               ") is outside region ", region->id));
}

bool RegionContainer::contains(const Vector3 &c) const {
  if (c.z() < orifice_.centre.z()) return false;
  // Region::match() would say that everything is inside a region with an open face.
  return (region_->inside(c.x(), c.y(), c.z()) != 0) == (region_->interior != 0);
}

void RegionContainer::contacts(const Vector3 &c, double reach, spot::WallContacts &contacts) const {
  contacts.clear();
  if (c.z() < orifice_.centre.z()) return;
  const int n = region_->surface(c.x(), c.y(), c.z(), reach);
  for (int i = 0; i < n; ++i) {
    // The distance from the vector: `r` is wrong for unions seen from outside.
    const Region::Contact &contact = region_->contact[i];
    const Vector3 from_wall(contact.delx, contact.dely, contact.delz);
    const double distance = from_wall.norm();
    if (distance > 0.0 && distance < reach) contacts.add({distance, from_wall / distance});
  }
}

bool RegionContainer::has_clearance(const Vector3 &spot) const {
  if (!contains(spot)) return false;
  spot::WallContacts close;
  contacts(spot, buffers_.side, close);
  return close.begin() == close.end();
}

Vector3 RegionContainer::keep_spot_inside(const Vector3 &start, const Vector3 &target) const {
  if (target.z() <= orifice_.centre.z() + buffers_.side) {
    // On its way in, the spot passes the opening; walls are asked once its buffer fits above it.
    return orifice_.keep_within(std::max(0.0, orifice_.radius - buffers_.base), target);
  }
  Vector3 position = target;
  spot::WallContacts close;
  for (int round = 0; round < 4 && contains(position); ++round) {
    contacts(position, buffers_.side, close);
    if (close.begin() == close.end()) return position;
    for (const spot::WallContact &wall : close) position += 2.0 * (buffers_.side - wall.distance) * wall.normal;
  }
  // Where reflections do not settle (edges, narrow places), only the upward part of the step is taken,
  // and no step where even that would leave the region.
  const Vector3 upwards(start.x(), start.y(), target.z());
  return has_clearance(upwards) || contains(upwards) ? upwards : start;
}

}  // namespace LAMMPS_NS
