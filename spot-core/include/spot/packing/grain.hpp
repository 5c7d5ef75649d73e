// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <functional>

#include "spot/base/vector.hpp"

namespace spot {

/// One grain as it goes into and comes out of a packing.
struct Grain {
  std::int64_t id;  ///< 0 or more
  Vector3 position;
  bool held = false;    ///< an obstacle: never moves, others are pushed off it
  double radius = 0.0;  ///< 0: half of the packing's diameter (length)

  bool operator==(const Grain& other) const {
    return id == other.id && position == other.position && held == other.held && radius == other.radius;
  }
};

using VisitGrain = std::function<void(const Grain&)>;
/// By many threads at once; which one, counted from 0.
using VisitGrainAtOnce = std::function<void(const Grain&, std::size_t thread)>;
/// Grains to be visited: all of them, or those that may have moved.
enum class Which { all, moved };

/// The largest overlap of two grains and whose it is.
struct Overlap {
  double depth = 0.0;  ///< 1 - distance / (sum of the two radii); 0 when no two grains overlap
  std::int64_t first = 0, second = 0;
};

/// The radius of a grain in a packing whose largest grains have this diameter. Throws InvalidPacking, naming the grain,
/// unless it is given as 0, for half of the diameter, or is between a quarter and half of it.
double radius_in(double diameter, const Grain& grain);

/// The volume of a grain over that of a grain of the reference diameter, in whole 1024ths (grain_volume), so that sums
/// are exact: 128 to 1024.
int volume_parts(double diameter, double radius);

}  // namespace spot
