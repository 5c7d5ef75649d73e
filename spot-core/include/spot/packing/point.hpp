// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>

#include "spot/walk/grain_volume.hpp"

namespace spot {

/// A place on the grid of the quantum, as the vector kernels load it: a quarter of a cache line.
///
/// Coordinates wrap around: only differences of places that are near to each other mean anything, and those are exact.
/// With a quantum of 2^-24 d or a little less, near means closer than 64 d.
struct alignas(16) Point {
  std::int32_t x, y, z;
  std::int32_t state;  ///< one of the states below; in a push, the bits of a float, the largest 1 - r^2/d^2

  /// States count as a fourth coordinate when distances to a move are measured, so that nothing that must stay is ever
  /// within reach of one.
  /// A free grain is swept while the sweep that moves it is being made. Between moves there are grains that come down
  /// until others bear them: they fall, which is to kernels as if they were swept, they rest for the time being,
  /// or they lie until all others do.
  static constexpr std::int32_t free = 0, swept = 1, falling = swept, resting = 2, laid = 3, held = 1 << 29,
                                empty = 1 << 30;
};

/// How large a grain is, where grains are unequal.
struct GrainSize {
  double radius;    ///< (length)
  float in_quanta;  ///< the same
  float volume;     ///< volume_parts()
};

/// Whom a move reaches: the share of a free point is (radius^2 - r^2) per_square, but no more than 1.
struct Reach {
  float radius_squared, per_square;
};

/// How far overlapping grains push each other apart in a sweep, and how they close gaps.
struct PushStrength {
  double in_contact;   ///< overlap at which two grains are left alone, in diameters
  double pair_share;   ///< of the overlap beyond that, by which each of two grains moves that both may
  double fixed_share;  ///< the same, of a grain against one that stays, or a wall
  /// Gaps of two grains beyond the distance at which they are left alone are closed, if they are narrower than the
  /// first, in diameters; by the second of what an overlap as large would be pushed apart by.
  double closing_gap = 0.0, closing_share = 0.0;
};

/// Of the corrections in a cell: the square of the longest, and how deep the deepest overlap was (as in a push).
struct Corrections {
  float longest_squared, depth;
};

}  // namespace spot
