// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/displacement.hpp"

namespace spot {

int displace(Packing& packing, const std::vector<std::uint32_t>& grains, const Move& move, double radius,
             double influence) {
  const Quantum& quantum = packing.quantum();
  const double dx = quantum.round(-influence * move.step.x());
  const double dy = quantum.round(-influence * move.step.y());
  const double dz = quantum.round(-influence * move.step.z());
  int moved = 0;
  for (const std::uint32_t i : grains) {
    if (packing.distance_squared(i, move.middle) > radius * radius) continue;
    packing.move(i, dx, dy, dz);
    ++moved;
  }
  return moved;
}

}  // namespace spot
