// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "spot/base/quantum.hpp"
#include "spot/base/vector.hpp"
#include "spot/packing/point.hpp"

namespace spot {

/// A cell, counted from the lowest corner of the lattice.
struct Cell {
  int x, y, z;
};

/// Consecutive cells along x, by their numbers among those held: from `first` to `last`, exclusive.
struct CellRow {
  std::uint32_t first, last;
};

/// The lattice of cells over a packing, and the places in them as whole numbers of quanta.
///
/// "From low": in the units of the deck, from the lowest corner of the lattice. A rank *holds* consecutive layers of
/// it; cells held are numbered with x fastest. The outermost cells also hold what lies beyond the lattice.
class CellLattice {
 public:
  /// `diameter`: of the largest grains. `extent`: the largest coordinate there can be. Throws InvalidParameter as
  /// Quantum does.
  CellLattice(double diameter, double extent);

  double diameter() const { return diameter_; }
  double extent() const { return extent_; }
  const Quantum& quantum() const { return quantum_; }
  /// Of the diameter, in quanta.
  double quanta_of_diameter() const { return diameter_ / quantum_.length(); }
  /// Lists of neighbours cover this shell around the diameter (length).
  double skin() const { return skin_; }

  const Vector3& low() const { return low_; }
  /// Of a cell (length).
  const std::array<double, 3>& edge() const { return edge_; }
  /// Cells along each axis.
  const std::array<int, 3>& size() const { return n_; }
  int layers() const { return n_[2]; }

  /// Spans a box. Throws InvalidPacking if that takes too many cells.
  void span(const Vector3& low, const Vector3& high);
  /// Spans what a lattice with this corner and size did.
  void span(const Vector3& low, const std::array<int, 3>& size);
  /// Whole cells that would have to be added, below along each axis and then above, for this place to be inside.
  std::array<int, 6> cells_to(const Vector3& place) const;
  /// Adds whole cells at the low and the high ends. Throws InvalidPacking if there are too many.
  void grow(const std::array<int, 3>& below, const std::array<int, 3>& above);

  /// Which layers are held, from `first` to `last`, exclusive.
  void hold(int first, int last) { first_layer_ = first, last_layer_ = last; }
  int first_layer() const { return first_layer_; }
  int last_layer() const { return last_layer_; }
  std::uint32_t cells_in_layer() const { return static_cast<std::uint32_t>(n_[0] * n_[1]); }
  std::uint32_t cells_held() const { return static_cast<std::uint32_t>(last_layer_ - first_layer_) * cells_in_layer(); }
  std::uint32_t first_cell_of(int layer) const {
    return static_cast<std::uint32_t>(layer - first_layer_) * cells_in_layer();
  }
  Cell cell(std::uint32_t number) const;
  std::uint32_t number_of(const Cell& cell) const {
    return static_cast<std::uint32_t>(((cell.z - first_layer_) * n_[1] + cell.y) * n_[0] + cell.x);
  }
  /// Among all cells of the lattice, whoever holds them.
  std::int64_t number_in_all(const Cell& cell) const {
    return (static_cast<std::int64_t>(cell.z) * n_[1] + cell.y) * n_[0] + cell.x;
  }

  std::array<std::int64_t, 3> quanta(const Vector3& from_low) const;
  Point wrapped(const Vector3& from_low) const;
  /// The place of a point that was listed in this cell, or near it.
  Vector3 from_low(const Point& point, const Cell& listed_in) const;
  int coordinate(double from_low, int axis) const {
    const double cell = from_low * per_edge_[static_cast<std::size_t>(axis)];
    const int n = n_[static_cast<std::size_t>(axis)];
    return cell < 0.0 ? 0 : cell >= n ? n - 1 : static_cast<int>(cell);
  }
  Cell cell_at(const Vector3& from_low) const {
    return {coordinate(from_low.x(), 0), coordinate(from_low.y(), 1), coordinate(from_low.z(), 2)};
  }
  int layer(double height) const { return coordinate(height - low_.z(), 2); }
  /// A number of whole cells along each axis, in wrapped quanta.
  Point wrapped_cells(const std::array<int, 3>& cells) const;

  /// Adds the rows of cells within reach of a place, in the layers held from `first` to `last`, exclusive.
  void find_rows(const Vector3& from_low, double reach, int first, int last, std::vector<CellRow>& rows) const;

 private:
  double diameter_, extent_;
  Quantum quantum_;
  double skin_;
  Vector3 low_ = Vector3::Zero();
  std::array<double, 3> edge_, per_edge_;    // of a cell, and 1 over it
  std::array<std::int64_t, 3> edge_quanta_;  // the same
  std::array<int, 3> n_ = {0, 0, 0};
  int first_layer_ = 0, last_layer_ = 0;
};

}  // namespace spot
