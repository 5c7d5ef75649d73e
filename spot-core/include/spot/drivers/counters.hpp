// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>

#include "spot/packing/point.hpp"

namespace spot {

/// What has happened since the start.
struct Counters {
  std::int64_t moves = 0;         ///< spot steps
  std::int64_t shares_moved = 0;  ///< shares in them of the grains that they enclosed, in 1024ths of a grain
  std::int64_t sweeps = 0;        ///< relaxation sweeps, over one region (time-ordered) or all that was due (windowed)
  std::int64_t grains_swept = 0;  ///< grains in them, each counted every time
  std::int64_t drained = 0;       ///< grains that left below the outlet

  /// <N>: grains that a move of a spot influences, each counted by its share, on average.
  double grains_per_move() const {
    return moves == 0 ? 0.0 : static_cast<double>(shares_moved) / (static_cast<double>(moves) * whole_share);
  }
};

}  // namespace spot
