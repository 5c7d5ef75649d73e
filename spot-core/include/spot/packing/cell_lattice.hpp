// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "spot/base/quantum.hpp"
#include "spot/base/vector.hpp"
#include "spot/geometry/periodic.hpp"
#include "spot/packing/cell_rows.hpp"
#include "spot/packing/point.hpp"

namespace spot {

/// A cell, counted from the lowest corner of the lattice.
struct Cell {
  int x, y, z;
};

/// The lattice of cells over a packing, and the places in them as whole numbers of quanta.
///
/// "From low": in the units of the deck, from the lowest corner of the lattice. A rank *holds* consecutive layers of
/// it; cells held are numbered with x fastest. The outermost cells also hold what lies beyond the lattice.
///
/// Along an axis on which space repeats, the lattice spans one period, and an *image* of the last cell is held before
/// the first, and one of the first after the last.
class CellLattice {
 public:
  /// `diameter`: of the largest grains. `extent`: the largest coordinate there can be. Throws InvalidParameter as
  /// Quantum does.
  CellLattice(double diameter, double extent, const Periodic& periodic = {});

  double diameter() const { return diameter_; }
  double extent() const { return extent_; }
  const Quantum& quantum() const { return quantum_; }
  /// Of the diameter, in quanta.
  double quanta_of_diameter() const { return diameter_ / quantum_.length(); }
  /// With ends that are multiples of the quantum.
  const Periodic& periodic() const { return periodic_; }
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
  std::uint32_t cells_in_row() const { return static_cast<std::uint32_t>(held(0)); }
  std::uint32_t cells_in_layer() const { return static_cast<std::uint32_t>(held(0) * held(1)); }
  std::uint32_t cells_held() const { return static_cast<std::uint32_t>(last_layer_ - first_layer_) * cells_in_layer(); }
  std::uint32_t first_cell_of(int layer) const {
    return static_cast<std::uint32_t>(layer - first_layer_) * cells_in_layer();
  }
  Cell cell(std::uint32_t number) const;
  std::uint32_t number_of(const Cell& cell) const {
    const int x = cell.x + images_[0], y = cell.y + images_[1];
    return static_cast<std::uint32_t>(((cell.z - first_layer_) * held(1) + y) * held(0) + x);
  }
  /// Among all cells of the lattice, whoever holds them; images apart.
  std::int64_t number_in_all(const Cell& cell) const {
    return (static_cast<std::int64_t>(cell.z) * n_[1] + cell.y) * n_[0] + cell.x;
  }
  Cell cell_in_all(std::int64_t number) const {
    return {static_cast<int>(number % n_[0]), static_cast<int>(number / n_[0] % n_[1]),
            static_cast<int>(number / n_[0] / n_[1])};
  }
  /// A grain is listed here from now on.
  void note_listed(const Vector3& from_low);
  /// Between which all grains are that were ever listed in a cell; the outermost are as large as it takes.
  std::pair<Vector3, Vector3> corners(const Cell& cell) const;
  bool is_image(const Cell& cell) const { return cell.x < 0 || cell.x >= n_[0] || cell.y < 0 || cell.y >= n_[1]; }
  /// The cell that an image is one of.
  Cell source_of(const Cell& image) const { return {(image.x + n_[0]) % n_[0], (image.y + n_[1]) % n_[1], image.z}; }
  /// From a place in the cell to its place in this image, in wrapped quanta.
  Point shift_to(const Cell& image) const;
  /// So many periods along x and y, in wrapped quanta.
  Point periods(int along_x, int along_y) const;

  std::array<std::int64_t, 3> quanta(const Vector3& from_low) const;
  Point wrapped(const Vector3& from_low) const;
  /// The place of a point that was listed in this cell, or near it.
  Vector3 from_low(const Point& point, const Cell& listed_in) const;
  /// The cell along an axis in which a place is, images apart.
  int coordinate(double from_low, int axis) const {
    const double cell = from_low * per_edge_[static_cast<std::size_t>(axis)];
    const int n = n_[static_cast<std::size_t>(axis)];
    return cell < 0.0 ? 0 : cell >= n ? n - 1 : static_cast<int>(cell);
  }
  /// Of a place in the period, where there is one.
  Cell cell_at(const Vector3& from_low) const {
    return {coordinate(from_low.x(), 0), coordinate(from_low.y(), 1), coordinate(from_low.z(), 2)};
  }
  int layer(double height) const { return coordinate(height - low_.z(), 2); }
  /// A number of whole cells along each axis, in wrapped quanta.
  Point wrapped_cells(const std::array<int, 3>& cells) const;

  /// Adds the rows of cells within reach of a place, of those asked for.
  void find_rows(const Vector3& from_low, double reach, const RowsAsked& asked, std::vector<CellRow>& rows) const;

 private:
  int held(int axis) const { return n_[static_cast<std::size_t>(axis)] + 2 * images_[static_cast<std::size_t>(axis)]; }
  void set_edge(std::size_t axis);
  template <typename X, typename Y>
  void find_rows(const Vector3& from_low, double reach, const RowsAsked& asked, const X& along_x, const Y& along_y,
                 std::vector<CellRow>& rows) const;

  double diameter_, extent_;
  Quantum quantum_;
  Periodic periodic_;
  double skin_;
  Vector3 low_ = Vector3::Zero();
  std::array<Vector3, 2> beyond_ = {Vector3::Zero(), Vector3::Zero()};  // how far grains were listed below and above it
  std::array<double, 3> edge_, per_edge_;                               // of a cell, and 1 over it
  std::array<std::int64_t, 3> edge_quanta_;                             // the same
  std::array<int, 3> n_ = {0, 0, 0};
  std::array<int, 3> images_ = {0, 0, 0};           // at each end, 0 or 1
  std::array<std::int64_t, 3> period_ = {0, 0, 0};  // in quanta
  int first_layer_ = 0, last_layer_ = 0;
};

}  // namespace spot
