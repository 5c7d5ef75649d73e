// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>

namespace spot::kernels {

/// Grains that push_off_neighbours() handles at a time.
constexpr int lanes = 8;

/// What the kernels need to know of a packing. Lists have list_capacity places a slot, filled up with an empty slot.
struct Slots {
  const double *x, *y, *z;
  const std::uint32_t* lists;
  std::uint32_t list_capacity;
  double diameter_squared;
  double share;  ///< of the overlap
  double shift;  ///< that rounds to the quantum, see Quantum
};

/// One build of all kernels. They are compiled several times, for different instruction sets, from kernels.inl; results
/// are the same bits for all (-ffp-contract=off, and no sum whose order could matter).
struct Kernels {
  const char* instruction_set;

  /// Adds `by` to the n points within a ball around `middle`; returns how many.
  int (*displace)(double* x, double* y, double* z, std::uint32_t n, const double* middle, double radius_squared,
                  const double* by);

  /// Pushes of all neighbours on each of `lanes` slots: share * (d - r) along the line of centres for r < d, each
  /// component rounded to the quantum. (d - r) / r is expanded in s = 1 - r^2/d^2, good to 1e-4 of itself for overlaps
  /// up to 0.05 d; deeper ones are pushed apart by somewhat less, which another sweep makes good.
  void (*push_off_neighbours)(const Slots& slots, const std::uint32_t* group, std::uint32_t longest_list,
                              double* push_x, double* push_y, double* push_z);

  /// Is any of n points farther from its reference than the root of `reach_squared`?
  bool (*any_beyond)(const double* x, const double* y, const double* z, const double* reference_x,
                     const double* reference_y, const double* reference_z, std::uint32_t n, double reach_squared);
};

/// The best build that this processor can run, or the one that the environment variable SPOT_INSTRUCTION_SET names
/// (base, x86-64-v3, x86-64-v4; for tests). Throws InvalidParameter if that one cannot run here.
const Kernels& best();

}  // namespace spot::kernels
