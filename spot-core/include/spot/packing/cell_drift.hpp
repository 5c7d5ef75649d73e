// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "spot/base/aligned_vector.hpp"
#include "spot/base/memory.hpp"

namespace spot {

/// How far the grains of each cell may be from their references, in quanta. Whoever moves grains adds to it, so it
/// knows as well in which cells some may have moved. Threads may call it at once for different cells.
class CellDrift {
 public:
  /// So many cells, of which no grain is away from its reference.
  void assign(std::size_t cells) {
    bound_.assign(cells, 0);
    moved_.assign(cells, 0);
  }

  std::int32_t operator[](std::uint32_t cell) const { return bound_[cell]; }
  const std::int32_t* data() const { return bound_.data(); }
  /// Of any cell.
  std::int32_t largest() const { return bound_.empty() ? 0 : *std::max_element(bound_.begin(), bound_.end()); }

  /// Grains of the cell move by at most this.
  void add(std::uint32_t cell, std::int32_t length) {
    bound_[cell] = static_cast<std::int32_t>(std::min<std::int64_t>(std::int64_t{bound_[cell]} + length, 1 << 30));
    moved_[cell] = 1;
  }
  /// Some have been found to be no farther, or will not move after all.
  void set(std::uint32_t cell, std::int32_t bound) { bound_[cell] = bound; }

  /// May a grain have moved in the cell, or come into it, since forget_moved()?
  bool moved(std::uint32_t cell) const { return moved_[cell] != 0; }
  void note_moved(std::uint32_t cell) { moved_[cell] = 1; }
  void forget_moved() { std::fill(moved_.begin(), moved_.end(), std::uint8_t{0}); }

  std::size_t memory() const { return bytes_in(bound_, moved_); }

 private:
  AlignedVector<std::int32_t> bound_;
  AlignedVector<std::uint8_t> moved_;  // no bits, since threads write them
};

}  // namespace spot
