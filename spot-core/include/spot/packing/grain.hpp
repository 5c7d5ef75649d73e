// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>

#include "spot/base/vector.hpp"

namespace spot {

/// One grain as it goes into and comes out of a packing.
struct Grain {
  std::int64_t id;  ///< 0 or more
  Vector3 position;
  bool held = false;  ///< an obstacle: never moves, others are pushed off it

  bool operator==(const Grain& other) const {
    return id == other.id && position == other.position && held == other.held;
  }
};

/// The largest overlap of two grains and whose it is.
struct Overlap {
  double depth = 0.0;  ///< 1 - distance / diameter; 0 when no two grains overlap
  std::int64_t first = 0, second = 0;
};

}  // namespace spot
