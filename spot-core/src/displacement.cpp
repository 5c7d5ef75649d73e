// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/displacement.hpp"

#include <algorithm>

namespace spot {

namespace {

/// A spot at the surface with fewer grains would throw them about.
constexpr double fewest_grains = 20.0;

}  // namespace

double largest_weight(const SpotParameters& parameters) {
  return std::max(1.0, parameters.fixed_volume / fewest_grains);
}

double fixed_volume_weight(const SpotParameters& parameters, double height, int grains) {
  if (parameters.fixed_volume == 0.0) return 1.0;
  const double z = std::clamp(height / parameters.radius, -1.0, 1.0);
  const double part = 0.5 + 0.75 * z - 0.25 * z * z * z;
  return parameters.fixed_volume * part / std::max(static_cast<double>(grains), fewest_grains * part + 1e-9);
}

int displace(Packing& packing, const std::vector<std::uint32_t>& grains, const Move& move, double radius,
             double influence) {
  const Quantum& quantum = packing.quantum();
  const Vector3 by = -influence * move.weight * move.step;
  const double dx = quantum.round(by.x()), dy = quantum.round(by.y()), dz = quantum.round(by.z());
  int moved = 0;
  for (const std::uint32_t i : grains) {
    if (packing.distance_squared(i, move.middle) > radius * radius) continue;
    packing.move(i, dx, dy, dz);
    ++moved;
  }
  return moved;
}

}  // namespace spot
