// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

#include "spot/packing/point.hpp"

namespace spot::kernels {

/// The grains that a move may displace: Coordinates, and `lanes` slots from each multiple of that in a list.
struct Places {
  std::int32_t *x, *y, *z;
  const float* state_squared;
  const std::uint32_t* blocks;  ///< slots over `lanes`
  std::size_t count;            ///< of these
};
/// Tilts of all slots.
struct TiltsOfPlaces {
  const std::int16_t *x, *y, *z;
};

/// Kernels work on whole packs of points: numbers of points given to them, except grains to be pushed, are multiples of
/// this, and neighbour lists have room for a multiple of `lanes`.
constexpr std::uint32_t pack = 4, lanes = 16;

/// Kernels that work on a list of grains fetch what belongs to a grain so many grains before they use it, so such lists
/// go on with as many that are fetched and not used.
constexpr std::uint32_t ahead = 8;

/// Lists of neighbours: that of a point begins with a `block` of `lanes` entries, and has `size` of them; what follows
/// in the last block is any valid index.
struct Lists {
  const std::uint32_t* neighbours;
  const std::uint32_t* block;
  const std::uint8_t* size;
};

/// Which gaps are closed, and how.
struct Gaps {
  float widest = 0.0f;  ///< r^2/d^2 - 1, d being how far apart grains are left alone; 0: none
  float share = 0.0f;   ///< of what an overlap as large would be pushed apart by
};

/// How grains push each other apart.
struct Push {
  float per_square;   ///< 1/d^2 in quanta
  float pair_share;   ///< of the overlap, by which each of two grains moves
  float fixed_share;  ///< of the overlap, by which a grain moves if the other stays
  Gaps gaps = {};
};

/// How unequal grains do: those of radii a and b go apart until they are (a + b) `touch` from each other.
struct UnequalPush {
  float touch;
  float pair_share, fixed_share;  ///< as above
  Gaps gaps = {};
};

/// One build of all kernels. They are compiled several times, for different instruction sets, from kernels.inl; results
/// are the same bits for all: every number goes through the same operations (-ffp-contract=off), and sums are of
/// integers. Lengths are in quanta, their squares in single precision.
struct Kernels {
  const char* instruction_set;

  /// The shares of the places in a move around `middle`, together, each cut to whole parts (grain_volume).
  int (*enclosed_volume)(const Places& places, const Point& middle, const Reach& reach);

  /// Adds to every place its share of `by`, cut to whole quanta.
  void (*displace)(const Places& places, const Point& middle, const Reach& reach, const Point& by);

  /// The same with a tilt for each: its share of `by` + `unit` tilt.
  void (*displace_tilted)(const Places& places, const TiltsOfPlaces& tilts, const Point& middle, const Reach& reach,
                          const Point& by, float unit);

  /// Counts a move for each place that it may displace.
  void (*count_received)(const Places& places, const Point& middle, const Reach& reach, std::uint32_t* received);

  /// For each of n grains, the sum of the pushes of its neighbours, and how deep they overlap it: share * (d - r) along
  /// the line of centres for r < d, each component cut to whole quanta; the pair's share if the neighbour is swept, the
  /// fixed one if not. (d - r) / r is expanded in s = 1 - r^2/d^2, good to 1e-4 of itself for overlaps up to 0.05 d;
  /// deeper ones are pushed apart by somewhat less, which another sweep makes good. Gaps that are to be closed are
  /// negative overlaps, of which no depth is told.
  void (*push_off_neighbours)(const Point* points, const std::uint32_t* grains, std::size_t n, const Lists& lists,
                              const Push& push, Point* pushes);

  /// The same two of unequal grains, where each has its own radius and counts by its own volume.
  int (*enclosed_volume_of_unequal)(const Places& places, const GrainSize* sizes, const Point& middle,
                                    const Reach& reach);
  void (*push_off_unequal_neighbours)(const Point* points, const GrainSize* sizes, const std::uint32_t* grains,
                                      std::size_t n, const Lists& lists, const UnequalPush& push, Point* pushes);

  /// Corrects the grains of some cells, one cell after the other, `in_cell` of them in each: a grain moves by its push
  /// and by the part `kept` of its last correction, cut to whole quanta, and remembers that as its last. It is free
  /// from then on.
  void (*correct)(Point* points, Point* last, const std::uint32_t* grains, const std::uint8_t* in_cell,
                  std::size_t cells, const Point* pushes, float kept, Corrections* corrections);

  /// Writes first, first + 1, ... of those of n points, empty ones apart, that are within reach of `centre`; returns
  /// how many. `found` has room for all of them.
  std::size_t (*find_within)(const Point* points, std::size_t n, const Point& centre, float reach_squared,
                             std::uint32_t first, std::uint32_t* found);

  /// Largest squared distance of a point from its reference.
  float (*farthest)(const Point* points, const Point* references, std::size_t n);

  /// Writes the indices of those of n values that are `least` or more; returns how many. `found` has room for all.
  std::size_t (*find_reached)(const std::int32_t* values, std::size_t n, std::int32_t least, std::uint32_t* found);
};

}  // namespace spot::kernels
