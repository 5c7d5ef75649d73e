// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "spot/packing.hpp"

namespace spot {

/// One step of one spot.
struct Move {
  double time;
  std::int64_t spot;  ///< id
  Vector3 middle;     ///< halfway between start and end of the step, where the influence is centred (2006)
  Vector3 step;       ///< dr_s: end minus start
};

/// Moves every one of the given grains with its centre within `radius` of the move's middle by
/// -influence * step, rounded to the quantum (2006, eq. 1). Returns how many grains moved.
int displace(Packing& packing, const std::vector<std::uint32_t>& grains, const Move& move, double radius,
             double influence);

}  // namespace spot
