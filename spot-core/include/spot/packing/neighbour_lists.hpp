// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "spot/base/aligned_vector.hpp"
#include "spot/packing/cells.hpp"
#include "spot/packing/wall_marks.hpp"
#include "spot/parallel/workers.hpp"

namespace spot {

namespace kernels {
struct Kernels;
struct Lists;
}  // namespace kernels

/// Slots of the neighbours of a grain.
struct Neighbours {
  const std::uint32_t *first, *last;
  const std::uint32_t* begin() const { return first; }
  const std::uint32_t* end() const { return last; }
};

/// The neighbours of every grain: those whose references are closer than diameter + skin. So lists follow from the
/// references alone, and hold every pair in contact, and with gaps that they are to hold, for as long as no grain is
/// farther from its reference than largest_drift(). Ghosts have lists, too.
///
/// Layout: each grain's list takes one or more blocks of kernels::lanes entries in one array; a list that outgrows its
/// blocks moves to others, and blocks left behind are used again.
class NeighbourLists : public SlotData {
 public:
  NeighbourLists(Cells& cells, WallMarks& walls, const kernels::Kernels& kernels);

  Neighbours of(std::uint32_t slot) const { return {list_of(slot), list_of(slot) + size_[slot]}; }

  /// Lists hold pairs with gaps (length) as wide as this, too, from the next time on that grains which have drifted are
  /// listed anew. Without, those in contact alone.
  void hold_gaps(double widest) { widest_gap_ = widest; }
  /// How far a grain may be from its reference (length): half a skin, less what gaps take of it.
  double largest_drift() const { return 0.5 * (cells_.lattice().skin() - widest_gap_); }

  /// Room for so many grains, before they are listed: an array that grew meanwhile would end up longer than needed.
  void reserve(std::size_t grains);
  /// Lists a grain and its neighbours with each other, and marks it if it is near a wall.
  void list(std::uint32_t slot, const Container& container);
  /// Lists many whose references are all in place already: workers find their neighbours and write their lists, and one
  /// of them writes down what is new to the neighbours, which is little.
  void list(const std::vector<Place>& places, const Container& container, Workers& workers);
  void unlist(std::uint32_t slot);
  /// Hands the list of one slot to another, which has none.
  void rename(std::uint32_t from, std::uint32_t to);

  /// For kernels; valid until something is listed.
  kernels::Lists view() const;

  void renumber(const std::vector<std::uint32_t>& now, std::size_t slots) override;
  std::size_t memory() const;

 private:
  /// What one worker has found for one grain after the other, and what is left to be written down.
  struct Finding {
    std::vector<std::uint32_t> found;  // neighbours of the grain at hand
    std::vector<CellRow> rows;
    std::vector<std::uint8_t> marks;  // of each grain
    struct Pair {
      std::uint32_t slot, neighbour;
    };
    std::vector<Pair> gone, come;                    // in the lists of grains that are not listed anew
    std::vector<std::uint32_t> crowded;              // grains whose lists need more room
    std::vector<std::vector<std::uint32_t>> crowds;  // their neighbours

    void clear() {
      marks.clear();
      gone.clear();
      come.clear();
      crowded.clear();
      crowds.clear();
    }
  };

  std::uint32_t* list_of(std::uint32_t slot);
  const std::uint32_t* list_of(std::uint32_t slot) const;
  void find_neighbours(std::uint32_t slot, Finding& finding) const;
  void find_changes(std::uint32_t slot, Finding& finding) const;
  void list(std::uint32_t slot, Finding& finding);
  void write_down(const Finding& finding);
  void add_neighbour(std::uint32_t slot, std::uint32_t neighbour);
  void remove_neighbour(std::uint32_t slot, std::uint32_t neighbour);
  void give_room(std::uint32_t slot);
  std::uint32_t take_blocks(std::size_t order);

  Cells& cells_;
  WallMarks& walls_;
  const kernels::Kernels& kernels_;
  double widest_gap_ = 0.0;
  AlignedVector<std::uint32_t> neighbours_;
  AlignedVector<std::uint32_t> block_;  // the first of each slot
  AlignedVector<std::uint8_t> room_;    // 2^(room - 1) blocks, or none
  AlignedVector<std::uint8_t> size_;
  std::array<std::vector<std::uint32_t>, 4> unused_;  // blocks, by how many there are in a row
  AlignedVector<std::uint8_t> anew_;                  // is the grain of a slot being listed anew?
  std::vector<Finding> findings_;
};

}  // namespace spot
