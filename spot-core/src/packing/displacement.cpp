// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/packing/displacement.hpp"

#include <algorithm>

namespace spot {

namespace {

/// A spot at the surface with fewer grains would throw them about.
constexpr double fewest_grains = 20.0;

}  // namespace

double largest_weight(const SpotParameters& parameters) {
  return std::max(1.0, parameters.fixed_volume / fewest_grains);
}

double part_above_outlet(InfluenceProfile profile, double z) {
  z = std::clamp(z, -1.0, 1.0);
  if (profile == InfluenceProfile::uniform) return 0.5 + 0.75 * z - 0.25 * z * z * z;
  return 0.5 + 0.9375 * (z - 2.0 / 3.0 * z * z * z + 0.2 * z * z * z * z * z);
}

double fixed_volume_weight(const SpotParameters& parameters, double height, int shares) {
  if (parameters.fixed_volume == 0.0) return 1.0;
  const double part = part_above_outlet(parameters.profile, height / parameters.radius);
  const double grains = static_cast<double>(shares) / whole_share;
  return parameters.fixed_volume * part / std::max(grains, fewest_grains * part + 1e-9);
}

namespace {

/// Of a grain at this squared distance, which is no more than R_s^2.
double share_at(const SpotParameters& spots, double squared) {
  if (spots.profile == InfluenceProfile::uniform) return 1.0;
  return 1.0 - squared / (spots.radius * spots.radius);
}

/// Of a grain with this volume_parts().
int parts_of(double share, int volume) { return static_cast<int>(share * volume); }

}  // namespace

int enclosed_shares(const Packing& packing, const std::vector<std::uint32_t>& grains, const Move& move,
                    const SpotParameters& spots) {
  int shares = 0;
  for (const std::uint32_t i : grains) {
    const double squared = packing.distance_squared(i, move.middle);
    if (squared <= spots.radius * spots.radius) shares += parts_of(share_at(spots, squared), packing.volume(i));
  }
  return shares;
}

int displace(Packing& packing, const std::vector<std::uint32_t>& grains, const Move& move, const SpotParameters& spots,
             MovesReceived* received) {
  const Quantum& quantum = packing.quantum();
  const Vector3 whole = -spots.influence * move.weight * move.step;
  int shares = 0;
  for (const std::uint32_t i : grains) {
    const double squared = packing.distance_squared(i, move.middle);
    if (squared > spots.radius * spots.radius) continue;
    const double share = share_at(spots, squared);
    const Vector3 by = share * whole;
    packing.move(i, quantum.round(by.x()), quantum.round(by.y()), quantum.round(by.z()));
    if (received) ++(*received)[packing.id(i)];
    shares += parts_of(share, packing.volume(i));
  }
  return shares;
}

}  // namespace spot
