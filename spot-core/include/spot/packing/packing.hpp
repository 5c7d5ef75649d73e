// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "spot/base/quantum.hpp"
#include "spot/geometry/container.hpp"
#include "spot/packing/cell_grid.hpp"
#include "spot/packing/grain.hpp"

namespace spot {

/// Spheres and the lists of their neighbours.
///
/// Layout: structure of arrays. Every grain has a *reference*, the place where it was listed last; cells and
/// lists follow from the references alone: j is a neighbour of i exactly if their references are closer than
/// the largest diameter + skin. A grain that has gone half the skin from its reference is listed anew, by itself,
/// in `refresh()`; so lists hold every pair in contact, and grains that do not move cost nothing.
///
/// Positions are multiples of `quantum()`; nothing computed here depends on the order of the grains. The quantum
/// follows from the largest grains and is at most 1e-6 of their diameter: of grains half as wide it is at most 2e-6,
/// still far below any overlap that matters.
///
/// Where space repeats, grains are kept in its cell, whose ends are multiples of the quantum too, and distances are
/// those to the nearest image.
class Packing {
 public:
  /// `diameter`: of the largest grains. `extent` is the largest coordinate (absolute value) a grain may ever have; both
  /// set the quantum. Throws InvalidPacking that names the grain if a position is not finite or beyond the extent, a
  /// radius is not as radius_in() has it, or an id is negative or occurs twice. Throws InvalidContainer if space
  /// repeats after less than 4 diameters or its cell is beyond the extent.
  Packing(double diameter, double extent, const std::vector<Grain>& grains, const Periodic& periodic = {});

  double diameter() const { return diameter_; }
  double extent() const { return extent_; }
  const Quantum& quantum() const { return quantum_; }
  /// Its ends are multiples of the quantum.
  const Periodic& periodic() const { return periodic_; }
  std::size_t size() const { return ids_.size() - removed_; }

  /// All grains, in increasing order of ids.
  std::vector<Grain> grains() const;
  Grain grain(std::size_t i) const { return {ids_[i], position(i), held(i), radii_[i]}; }

  /// From the next refresh() on, lists hold pairs with gaps (length) as wide as this, too.
  void hold_gaps(double widest);

  /// Sorts the grains in memory when that has become worth while; indices change, lists are up to date.
  void refresh(const Container& container) {
    if (listed_since_sort_ >= sort_after_) sort(container);
    update_lists(container);
  }

  /// Brings cells, lists and wall marks up to date, to be called before they are used after a move.
  void update_lists(const Container& container) {
    if (!drifted_.empty()) list_drifted(container);
  }

  /// Marks the grains near walls anew, as after the walls changed.
  void mark_near_walls(const Container& container);

  /// Number of indices; removed grains keep theirs for a while.
  std::size_t slots() const { return ids_.size(); }
  bool present(std::size_t i) const { return cell_[i] != nowhere; }
  std::int64_t id(std::size_t i) const { return ids_[i]; }
  Vector3 position(std::size_t i) const { return {x_[i], y_[i], z_[i]}; }
  double radius(std::size_t i) const { return radii_[i]; }
  /// As volume_parts() has it.
  int volume(std::size_t i) const { return volumes_[i]; }
  bool held(std::size_t i) const { return held_[i] != 0; }
  bool near_wall(std::size_t i) const { return near_wall_[i] != 0; }
  const double* x() const { return x_.data(); }
  const double* y() const { return y_.data(); }
  const double* z() const { return z_.data(); }

  /// First and last (exclusive) index of the list of grain i.
  std::pair<const std::uint32_t*, const std::uint32_t*> neighbours(std::size_t i) const {
    const std::uint32_t* first = neighbours_.data() + i * list_capacity_;
    return {first, first + list_size_[i]};
  }

  double distance_squared(std::size_t i, const Vector3& point) const {
    double x = x_[i] - point.x(), y = y_[i] - point.y();
    const double z = z_[i] - point.z();
    periodic_.shorten(x, y);
    return x * x + y * y + z * z;
  }

  /// Puts the grains that are not held and within `reach` of `point` into `found`, in no particular order.
  /// The lists must be up to date.
  void find_movable(const Vector3& point, double reach, std::vector<std::uint32_t>& found) const;

  /// Moves grain i by a displacement whose components are multiples of the quantum.
  void move(std::uint32_t i, double dx, double dy, double dz) {
    x_[i] += dx;
    y_[i] += dy;
    z_[i] += dz;
    periodic_.wrap(x_[i], y_[i]);
    double ex = x_[i] - reference_x_[i], ey = y_[i] - reference_y_[i];
    const double ez = z_[i] - reference_z_[i];
    periodic_.shorten(ex, ey);
    if (ex * ex + ey * ey + ez * ez > largest_drift_ * largest_drift_) drifted_.push_back(i);
  }

  /// Takes grain i out.
  Grain remove(std::uint32_t i);

  /// The largest overlap of two grains. The lists must be up to date.
  Overlap largest_overlap() const;
  /// The same of some grains and their neighbours.
  Overlap largest_overlap(const std::vector<std::uint32_t>& grains) const;

  /// Bytes held.
  std::size_t memory() const;

 private:
  static constexpr std::uint32_t nowhere = 0xffffffff;

  void list_drifted(const Container& container);
  void sort(const Container& container);
  void unlist(std::uint32_t i);
  void list(std::uint32_t i, const Container& container);
  void mark_near_wall(std::uint32_t i, const Container& container);
  void find_deeper_overlap(std::uint32_t i, Overlap& overlap) const;
  void add_neighbour(std::uint32_t i, std::uint32_t j);
  void lengthen_lists();

  double diameter_, extent_, half_skin_, largest_drift_;  // from a reference: half a skin, less what gaps take
  Quantum quantum_;
  Periodic periodic_;
  std::vector<std::int64_t> ids_;
  std::vector<double> x_, y_, z_, radii_, reference_x_, reference_y_, reference_z_;
  std::vector<std::uint16_t> volumes_;
  std::vector<char> held_, near_wall_;
  std::size_t removed_ = 0;

  CellGrid grid_;                          // of the references
  std::vector<std::uint32_t> cell_;        // of each grain; nowhere once removed
  std::vector<std::uint32_t> neighbours_;  // list_capacity_ places a grain
  std::vector<std::uint16_t> list_size_;
  std::size_t list_capacity_ = 16;

  std::vector<std::uint32_t> drifted_;  // farther from their references; repeats are harmless
  std::size_t listed_since_sort_ = 0, sort_after_ = 0;
};

}  // namespace spot
