// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "spot/packing/tiled_packing.hpp"

namespace spot {

/// Some grains, and what pushes each of them, in quanta.
struct PushedGrains {
  std::vector<std::uint32_t> slots;  ///< of `count` grains, and kernels::ahead more
  std::size_t count = 0;
  std::vector<std::uint32_t> near_walls;  ///< places in `slots` of those near walls
  std::vector<Point> pushes;              ///< and, in place of a state, how deep the deepest overlap is
};

/// Finds the pushes of neighbours and of walls across an axis, all by where grains are now.
void find_pushes(const TiledPacking& packing, const PushStrength& strength, PushedGrains& grains);

/// Adds those of all other walls, which the container may have to be asked for by one thread alone.
void add_pushes_of_other_walls(const TiledPacking& packing, double fixed_share, const Container& container,
                               PushedGrains& grains);

}  // namespace spot
