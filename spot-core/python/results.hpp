// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <vector>

#include "spot/packing/grain.hpp"
#include "spot/walk/spots.hpp"

namespace spotcore {

/// How far a call has come.
struct Progress {
  double time, until;
  std::int64_t grains, drained, spots;
};

/// Grains that have left, in the order in which they did.
struct Drained {
  std::vector<spot::Grain> grains;
  std::vector<double> times;  // ends of the windows in which they left
  std::vector<std::int64_t> outlets;
};

/// The spots at one time.
struct Spots {
  std::vector<spot::Spot> all;
};

void bind_results(pybind11::module_& module);

}  // namespace spotcore
