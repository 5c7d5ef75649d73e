// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>

#include "spot/walk/grain_volume.hpp"

namespace spot {

/// What has happened since the start.
struct Counters {
  std::int64_t moves = 0;         ///< spot steps
  std::int64_t volume_moved = 0;  ///< grain volume that they enclosed, by shares of influence (1024 = grain_volume)
  std::int64_t sweeps = 0;        ///< relaxation sweeps, over one region (time-ordered) or some cells (windowed)
  std::int64_t grains_swept = 0;  ///< grains in them, each counted every time
  /// That spots have left in the packing, less what they took up there, in CriticalState::volume_parts-ths of a newborn
  /// spot's.
  std::int64_t volume_left = 0;
  std::int64_t drained = 0;       ///< grains that left below the outlet

  /// <N>: grain volume that a move of a spot encloses, on average, in volumes of a grain of the reference diameter.
  double grains_per_move() const {
    return moves == 0 ? 0.0 : static_cast<double>(volume_moved) / (static_cast<double>(moves) * grain_volume);
  }
};

}  // namespace spot
