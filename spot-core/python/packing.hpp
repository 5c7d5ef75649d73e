// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <vector>

#include "arrays.hpp"
#include "spot/packing/grain.hpp"

namespace spotcore {

/// Grains as Python has them: arrays, which nobody writes once they are here.
class Packing {
 public:
  /// `radius`: a number, or one for each grain. `ids`, `held`: arrays, or None. Throws spot::InvalidPacking, naming the
  /// argument, for arrays of another shape or kind and radii that are not positive.
  Packing(const py::object& positions, const py::object& radius, const py::object& ids, const py::object& held);
  /// All of the same size.
  Packing(Doubles positions, Doubles radii, Integers ids, Booleans held);

  std::vector<spot::Grain> grains() const;
  std::size_t size() const { return static_cast<std::size_t>(ids_.size()); }
  /// Of the smallest and of the largest grains; 0 if there are none.
  double smallest_diameter() const { return 2.0 * smallest_radius_; }
  double diameter() const { return 2.0 * largest_radius_; }
  /// The largest coordinate, without its sign (length).
  double extent() const;

  const Doubles& positions() const { return positions_; }
  const Doubles& radii() const { return radii_; }
  const Integers& ids() const { return ids_; }
  const Booleans& held() const { return held_; }

 private:
  void find_sizes();

  Doubles positions_, radii_;
  Integers ids_;
  Booleans held_;
  double smallest_radius_ = 0.0, largest_radius_ = 0.0;
};

void bind_packing(py::module_& module);

}  // namespace spotcore
