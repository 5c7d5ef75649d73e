// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "spot/packing.hpp"
#include "spot/parameters.hpp"

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

/// The weight of a move whose spot, with its middle at `height` above the outlet, encloses so many grains, when spots
/// carry a fixed volume: N part(height) / max(grains, 20), part(z) = 1/2 + 3 z / (4 R_s) - z^3 / (4 R_s^3) being the
/// part of the spot above the outlet (2010, section 3.3). 1 if the parameters say that they don't.
double fixed_volume_weight(const SpotParameters& parameters, double height, int grains);

/// No weight is larger.
double largest_weight(const SpotParameters& parameters);

/// Moves every one of the given grains with its centre within `radius` of the move's middle by
/// -weight * influence * step, rounded to the quantum (2006, eq. 1). Returns how many grains moved.
int displace(Packing& packing, const std::vector<std::uint32_t>& grains, const Move& move, double radius,
             double influence);

}  // namespace spot
