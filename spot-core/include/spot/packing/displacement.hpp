// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "spot/packing/packing.hpp"
#include "spot/packing/point.hpp"
#include "spot/walk/grain_volume.hpp"
#include "spot/walk/move.hpp"
#include "spot/walk/parameters.hpp"

namespace spot {

/// How many moves have moved a grain, by its id.
using MovesReceived = std::unordered_map<std::int64_t, std::int64_t>;

/// The weight of a move whose spot, with its middle at `height` above the outlet, encloses this grain volume (1024 =
/// grain_volume), when spots carry a fixed one: N V part / max(grains, 20 V part), where `part` of the spot is above
/// the outlet, V is `volume`, what it carries over that of a newborn one, and volumes are in those of a grain of mean
/// volume (2010, section 3.3, with V = 1). V if the parameters say that they don't.
double fixed_volume_weight(const SpotParameters& parameters, double height, int enclosed, double volume = 1.0);

/// No weight is larger.
double largest_weight(const SpotParameters& parameters);

/// The volume of the given grains that a move encloses, each counted by its share of the influence (1024 =
/// grain_volume).
int enclosed_volume(const Packing& packing, const std::vector<std::uint32_t>& grains, const Move& move,
                    const SpotParameters& spots);

/// Moves every one of the given grains with its centre within R_s of the move's middle by its share of
/// -weight * influence * step, rounded to the quantum (2006, eq. 1). Returns the volume that the move
/// encloses, and counts the move for each of them in `received`, if there is one.
int displace(Packing& packing, const std::vector<std::uint32_t>& grains, const Move& move, const SpotParameters& spots,
             MovesReceived* received = nullptr);

}  // namespace spot
