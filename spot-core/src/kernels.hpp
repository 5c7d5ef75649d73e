// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

#include "spot/point.hpp"

namespace spot::kernels {

/// Neighbour lists are filled up to a multiple of this with a point that is out of everybody's reach.
constexpr std::uint32_t lanes = 8;

/// Lists of neighbours: `capacity` places a point, `size` of them in use.
struct Lists {
  const std::uint32_t* neighbours;
  const std::uint8_t* size;
  std::uint32_t capacity;
};

/// How grains push each other apart.
struct Push {
  double diameter;
  double share;  ///< of the overlap, by which each moves
  double shift;  ///< that rounds to the quantum, see Quantum
};

/// One build of all kernels. They are compiled several times, for different instruction sets, from kernels.inl; results
/// are the same bits for all (-ffp-contract=off, and only sums that are exact).
struct Kernels {
  const char* instruction_set;

  /// Adds `by` to the points within `radius` of `middle`; returns how many. n is even.
  int (*displace)(Point* points, std::size_t n, const Point& middle, double radius, const Point& by);

  /// For each of n grains, the sum of the pushes of its neighbours, and how deep they overlap it: share * (d - r) along
  /// the line of centres for r < d, each component rounded to the quantum. (d - r) / r is expanded in s = 1 - r^2/d^2,
  /// good to 1e-4 of itself for overlaps up to 0.05 d; deeper ones are pushed apart by somewhat less, which another
  /// sweep makes good.
  void (*push_off_neighbours)(const Point* points, const std::uint32_t* grains, std::size_t n, const Lists& lists,
                              const Push& push, Point* pushes);

  /// Is any of n points farther than `reach` from its reference? n is even.
  bool (*any_beyond)(const Point* points, const Point* references, std::size_t n, double reach);
};

/// The best build that this processor can run, or the one that the environment variable SPOT_INSTRUCTION_SET names
/// (base, x86-64-v3, x86-64-v4; for tests). Throws InvalidParameter if that one cannot run here.
const Kernels& best();

}  // namespace spot::kernels
