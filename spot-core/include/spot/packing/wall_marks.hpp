// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "spot/base/aligned_vector.hpp"
#include "spot/geometry/container.hpp"
#include "spot/packing/cells.hpp"

namespace spot {

/// Which grains are near walls, so that no others need to ask; and how far walls push them.
///
/// A mark holds for as long as the list of a grain: it says which walls the grain may touch before it is listed anew.
/// Walls across an axis are compared as integers; all other walls are asked for.
class WallMarks : public SlotData {
 public:
  explicit WallMarks(Cells& cells) : cells_(cells) { cells.attach(*this); }

  /// Marks all own grains anew, as after the walls changed.
  void mark_all(const Container& container);
  /// The mark of one grain, by where it was listed.
  std::uint8_t mark_of(std::uint32_t slot, const Container& container) const;
  void mark(std::uint32_t slot, std::uint8_t mark);
  void find_planes(const Container& container);

  bool near_wall(std::uint32_t slot) const { return near_wall_[slot] != 0; }
  /// Has any grain of this cell ever been near a wall?
  bool cell_near_wall(std::uint32_t cell) const { return cell_near_wall_[cell] != 0; }

  /// Adds to a push what takes the grain off the walls that it overlaps: `strength` times the overlap. Of walls across
  /// an axis, and of all others.
  void push_off_planes(std::uint32_t slot, float strength, Point& push) const;
  void push_off_others(std::uint32_t slot, double strength, const Container& container, Point& push) const;

  void renumber(const std::vector<std::uint32_t>& now, std::size_t slots) override;
  std::size_t memory() const;

 private:
  struct TouchingPlane {
    std::int32_t Point::*axis;
    double at, low;  // of the plane, and of the lattice along its axis
    bool grains_below;
    std::int32_t largest_touch;  // it with their centres here, in wrapped quanta from low
  };

  std::int32_t touching(const TouchingPlane& plane, double radius) const;
  void other_contacts(const Container& container, const Vector3& centre, double reach, WallContacts& contacts) const;

  Cells& cells_;
  std::vector<TouchingPlane> planes_;      // the container's axis planes, unless there are too many
  AlignedVector<std::uint8_t> near_wall_;  // a bit for each of these; the highest for all other walls
  AlignedVector<std::uint8_t> cell_near_wall_;
};

}  // namespace spot
