// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>

#include "spot/base/vector.hpp"

namespace spot {

/// One step of one spot.
struct Move {
  double time;
  std::int64_t spot;        ///< id
  Vector3 middle;           ///< halfway between start and end of the step, where the influence is centred (2006)
  Vector3 step;             ///< dr_s: end minus start
  double weight = 1.0;      ///< factor on the influence, see fixed_volume_weight()
  std::int64_t number = 0;  ///< of this step of the spot, from 1
  double chance = 0.0;      ///< a uniform random number of this step, for whoever draws lots
};

}  // namespace spot
