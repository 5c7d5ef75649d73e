// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "spot/packing/tiled_packing.hpp"

namespace spot {

/// What bears the grains of a packing: neighbours, walls, the floor, and the packing's outflow over the outlets.
class Bearing {
 public:
  Bearing(const TiledPacking& packing, const Container& container)
      : packing_(packing), cells_(packing.cells()), container_(container) {}

  /// Is there anybody lower nearby, a wall, or an outlet, who may bear this grain?
  bool is_borne(std::uint32_t slot) const;

  /// Does it lie on the floor, or on what stands in an outlet?
  bool is_on_floor(std::uint32_t slot) const;

  /// Is this place no higher than `reach` (length) above an outlet? The packing there is borne by what flows out of
  /// it, which is the spots' business.
  bool is_over_outlet(const Vector3& place, double reach) const;

  /// How deep a grain here has sunk into an outlet, which is a floor until spots come, in its diameters.
  double depth_in_outlet(std::uint32_t slot) const;

  /// Unit vectors from everything that a grain touches to the grain; of grains that come down, from those that rest, or
  /// only from those that lie (`least`).
  std::vector<Vector3> contact_normals(std::uint32_t slot, std::int32_t least) const;

  /// Adds to a push what takes a grain, if it were at `place`, off those that bear it: neighbours, unless they are
  /// themselves coming down from above it (nobody has to bear what still falls, or grains at the bottom of a heap would
  /// be pressed into each other), and walls. Returns the deepest of the overlaps, in diameters, less that in contact.
  double push_off(std::uint32_t slot, const Point& place, double in_contact, Point& push) const;

 private:
  bool is_near_floor_or_slope(const Vector3& place, double reach) const;

  const TiledPacking& packing_;
  const Cells& cells_;
  const Container& container_;
};

}  // namespace spot
