// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/relaxation/pushes.hpp"

#include "packing/push_off_neighbours.hpp"
#include "packing/wrapped_integers.hpp"

namespace spot {

namespace {

/// Centres that coincide have no line between them; part them along x, by id so that both agree.
void part_coincident(const TiledPacking& packing, double pair_share, PushedGrains& grains) {
  const Cells& cells = packing.cells();
  for (std::size_t k = 0; k < grains.count; ++k) {
    if (depth_of(grains.pushes[k]) < 1.0f) continue;
    const std::uint32_t i = grains.slots[k];
    for (const std::uint32_t j : packing.lists().of(i)) {
      const Point apart = minus(cells.points[i], cells.points[j]);
      if (apart.x != 0 || apart.y != 0 || apart.z != 0) continue;
      const double by = pair_share * (cells.radius(i) + cells.radius(j));
      add(grains.pushes[k], cells.lattice().wrapped({cells.ids[i] < cells.ids[j] ? -by : by, 0.0, 0.0}));
    }
  }
}

}  // namespace

void find_pushes(const TiledPacking& packing, const PushStrength& strength, PushedGrains& grains) {
  grains.pushes.resize(grains.count);
  push_off_neighbours(packing.kernels(), packing.cells(), packing.lists(), grains.slots.data(), grains.count, strength,
                      grains.pushes.data());
  part_coincident(packing, strength.pair_share, grains);
  for (const std::uint32_t k : grains.near_walls)
    packing.walls().push_off_planes(grains.slots[k], static_cast<float>(strength.fixed_share), grains.pushes[k]);
}

void add_pushes_of_other_walls(const TiledPacking& packing, double fixed_share, const Container& container,
                               PushedGrains& grains) {
  for (const std::uint32_t k : grains.near_walls)
    packing.walls().push_off_others(grains.slots[k], fixed_share, container, grains.pushes[k]);
}

}  // namespace spot
