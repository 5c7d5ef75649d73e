// SPDX-License-Identifier: GPL-2.0-or-later
// Layers of cells as they go elsewhere: into a saved state, or to another rank.
#pragma once

#include <vector>

#include "spot/base/bytes.hpp"
#include "spot/packing/cells.hpp"

namespace spot {

/// A grain; its cell, of the whole lattice, tells how often the wrapped coordinates have wrapped around.
struct SavedGrain {
  std::int64_t id, cell;
  Point point, reference, correction;
  double radius;
};

struct SavedCell {
  std::int64_t cell;
  std::int32_t unrelaxed, drift;
};

struct SavedLayers {
  std::vector<SavedGrain> grains;
  std::vector<SavedCell> cells;

  /// Adds what append_layers() has appended. Throws InvalidState if it is damaged.
  void take(ByteReader& reader, const CellLattice& lattice);

  bool unequal(double diameter) const;

  /// Fills the own layers of cells, which are empty; what belongs to others is passed over.
  void fill(Cells& cells) const;

  /// Of the whole lattice.
  std::vector<std::int64_t> grains_in_layers(const CellLattice& lattice) const;
};

/// Appends what is in some of the own layers, from `first` to `last`, exclusive.
void append_layers(Bytes& bytes, const Cells& cells, int first, int last);

}  // namespace spot
