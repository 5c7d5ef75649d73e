// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "spot/packing/cell_lattice.hpp"
#include "spot/parallel/slabs.hpp"

namespace spot {

enum Side { below, above };

/// Which cells of a lattice a rank holds, by their numbers among those held: its own layers, the layer next to them on
/// each side, of which it has copies (the ghost layers), and, where space repeats, images of cells at the other end.
class HeldCells {
 public:
  explicit HeldCells(const CellLattice& lattice) : lattice_(lattice) {}

  CellLattice& lattice() { return lattice_; }
  const CellLattice& lattice() const { return lattice_; }
  const Slabs& slabs() const { return slabs_; }
  int rank() const { return rank_; }

  int own_layers() const { return slabs_.first(rank_ + 1) - slabs_.first(rank_); }
  int first_own_layer() const { return slabs_.first(rank_); }
  bool has_ghosts(Side side) const { return ghost_layers_[side] != 0; }
  /// The first cell of the own layer next to a ghost layer, and of that ghost layer.
  std::uint32_t first_of_border(Side side) const { return side == below ? first_own() : last_own() - in_layer(); }
  std::uint32_t first_of_ghosts(Side side) const { return side == below ? 0 : last_own(); }
  std::uint32_t count() const { return lattice_.cells_held(); }
  std::uint32_t first_own() const { return static_cast<std::uint32_t>(ghost_layers_[below]) * in_layer(); }
  std::uint32_t last_own() const { return first_own() + static_cast<std::uint32_t>(own_layers()) * in_layer(); }
  std::uint32_t in_layer() const { return lattice_.cells_in_layer(); }
  bool own(std::uint32_t cell) const { return cell >= first_own() && cell < last_own() && !is_image(cell); }
  /// Among the own layers.
  std::size_t layer_of(std::uint32_t cell) const { return (cell - first_own()) / in_layer(); }

  bool repeat() const { return !images_.empty(); }
  bool is_image(std::uint32_t cell) const { return repeat() && is_image_[cell] != 0; }
  /// Of a cell that is none itself.
  const std::vector<std::uint32_t>& images_of(std::uint32_t cell) const { return images_[cell]; }

 protected:
  /// Throws InvalidPacking if a rank would hold more cells than this.
  void hold_layers(const Slabs& slabs, int rank, double most_cells);

 private:
  CellLattice lattice_;
  Slabs slabs_{std::vector<std::int64_t>{0}, 1};
  int rank_ = 0;
  std::array<int, 2> ghost_layers_ = {0, 0};        // of the ranks below and above: 0 or 1
  std::vector<std::uint8_t> is_image_;              // of each cell, if space repeats
  std::vector<std::vector<std::uint32_t>> images_;  // the same
};

}  // namespace spot
