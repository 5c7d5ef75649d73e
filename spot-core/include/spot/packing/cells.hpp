// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "spot/base/aligned_vector.hpp"
#include "spot/packing/cell_drift.hpp"
#include "spot/packing/coordinates.hpp"
#include "spot/packing/grain.hpp"
#include "spot/packing/held_cells.hpp"
#include "spot/packing/point.hpp"
#include "spot/packing/slot_data.hpp"

namespace spot {

/// A place for a grain in a cell held; slots change when cells get more room, places don't.
struct Place {
  std::uint32_t cell, in_cell;
};

/// Grains in the cells of a lattice, with room in each cell for as many as it needs.
///
/// Layout: every cell has consecutive *slots*, a multiple of kernels::pack, cell after cell, so that a row of cells is
/// one contiguous range of slots; a row along all of x is a multiple of kernels::lanes. Empty slots hold points that
/// are in nobody's reach. A grain is in the cell of its *reference* (Verlet reference position), the place where it was
/// listed last.
///
/// Of the grains in ghost layers and images there are copies.
class Cells : public HeldCells {
 public:
  using HeldCells::HeldCells;
  Cells(const Cells&) = delete;
  Cells& operator=(const Cells&) = delete;

  /// Empties all cells, of the layers that a rank then owns or has ghosts of. Throws InvalidPacking if there are too
  /// many.
  void hold(const Slabs& slabs, int rank);
  /// `data` follows the slots for as long as these cells exist.
  void attach(SlotData& data) { attached_.push_back(&data); }

  // Sizes. Equal grains, all of the lattice's diameter, keep none.
  /// Grains are unequal from now on, all that are there being of the largest size.
  void allow_unequal();
  bool unequal() const { return unequal_; }
  double radius(std::uint32_t slot) const { return unequal_ ? sizes[slot].radius : 0.5 * lattice().diameter(); }
  /// Of the centres of two grains that touch, in quanta.
  double touching_distance(std::uint32_t a, std::uint32_t b) const {
    return (radius(a) + radius(b)) / lattice().quantum().length();
  }

  // Tilts, where grains go against their neighbours (NonaffineMotion).
  /// Grains have tilts from now on, none of which has been drawn.
  void give_tilts();
  bool tilted() const { return tilted_; }
  // Slots.
  std::uint32_t slots() const { return first_slot_.back(); }
  std::uint32_t first_slot(std::uint32_t cell) const { return first_slot_[cell]; }
  std::uint32_t end_slot(std::uint32_t cell) const { return first_slot_[cell + 1]; }
  std::uint32_t slot(const Place& place) const { return first_slot_[place.cell] + place.in_cell; }
  std::uint32_t cell_of(std::uint32_t slot) const { return cell_of_[slot]; }
  Place place_of(std::uint32_t slot) const { return {cell_of_[slot], slot - first_slot_[cell_of_[slot]]}; }
  bool occupied(std::uint32_t slot) const { return points[slot].state != Point::empty; }
  /// Calls visit(slot) for all grains of these cells.
  template <typename Visit>
  void visit(std::uint32_t first_cell, std::uint32_t last_cell, const Visit& visit) const {
    for (std::uint32_t slot = first_slot_[first_cell]; slot < first_slot_[last_cell]; ++slot)
      if (occupied(slot)) visit(slot);
  }
  template <typename Visit>
  void visit_own(const Visit& visit) const {
    this->visit(first_own(), last_own(), [&](std::uint32_t slot) {
      if (!is_image(cell_of(slot))) visit(slot);
    });
  }
  template <typename Visit>
  void visit_ghosts(const Visit& visit) const {
    this->visit(0, first_own(), visit);
    this->visit(last_own(), count(), visit);
    if (!repeat()) return;
    this->visit(first_own(), last_own(), [&](std::uint32_t slot) {
      if (is_image(cell_of(slot))) visit(slot);
    });
  }

  /// Calls visit(position) for own grains, layer by layer from the top, but for those of cells that are covered, when
  /// it is told between which corners their grains are. Whatever is below a covered cell must be covered, too.
  void visit_uncovered(const std::function<void(const Vector3&)>& visit,
                       const std::function<bool(const Vector3& low, const Vector3& high)>& is_covered) const;

  /// An empty place in a cell; if there is none, slots are numbered anew. Throws InvalidPacking if there are too many.
  Place ensure_room(std::uint32_t cell);
  /// As many slots in a cell as a place in it needs.
  void ensure_place(const Place& place);
  /// `radius`: of the largest grains, unless some are unequal.
  void occupy(std::uint32_t slot, std::int64_t id, const Point& point, const Point& reference, double radius);
  void vacate(std::uint32_t slot);
  /// What neighbouring ranks have copies of has changed.
  void note_change(std::uint32_t slot);
  /// Places in own border layers in which something has changed since they were taken last.
  std::vector<Place> take_changes(Side side) { return std::exchange(changed_[side], {}); }
  /// The same in any cells that there may be images of.
  std::vector<Place> take_changes_seen_in_images() { return std::exchange(changed_in_images_, {}); }
  /// Takes over what goes with a grain, besides what occupy() does, from another slot.
  void follow(std::uint32_t slot, std::uint32_t from);

  /// Grains owned.
  std::size_t size() const { return size_; }
  Vector3 from_low(const Point& point, std::uint32_t cell) const {
    return lattice().from_low(point, lattice().cell(cell));
  }
  Vector3 position(std::uint32_t slot) const { return lattice().low() + from_low(points[slot], cell_of_[slot]); }
  Grain grain(std::uint32_t slot) const { return grain(slot, lattice().cell(cell_of(slot))); }
  Grain grain(std::uint32_t slot, const Cell& listed_in) const;
  std::vector<std::int64_t> grains_in_own_layers() const;
  std::size_t memory() const;

  // Of every slot.
  AlignedVector<Point> points, references, corrections;  ///< `corrections`: the last, as far as a solver carries it on
  Coordinates coordinates;                               ///< for `points`, while moves displace them
  Tilts tilts;                                           ///< if they have any; as of the start of a window
  AlignedVector<std::int64_t> ids;                       ///< -1 in empty slots
  AlignedVector<GrainSize> sizes;                        ///< if they are unequal
  // Of every cell.
  AlignedVector<std::int32_t> unrelaxed;  ///< moves that have reached into it since it was relaxed, in sixteenths
  CellDrift drift;                        ///< how far grains may be from their references
  /// Places of this rank to which grains came that are neither free nor held, and perhaps others.
  std::vector<Place> in_motion;

  /// Parts of a move in `unrelaxed`.
  static constexpr std::int32_t parts_of_move = 16;

 private:
  void give_room(std::uint32_t cell);
  GrainSize size_of(double radius) const;

  AlignedVector<std::uint32_t> first_slot_ = {0};  // of each cell, and the end of the last
  AlignedVector<std::uint32_t> cell_of_;           // of each slot
  std::vector<SlotData*> attached_;
  std::array<std::vector<Place>, 2> changed_;
  std::vector<Place> changed_in_images_;
  std::size_t size_ = 0;
  bool unequal_ = false, tilted_ = false;
};

}  // namespace spot
