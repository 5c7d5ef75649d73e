// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/packing/displacement.hpp"

#include <algorithm>

#include "spot/walk/calibration.hpp"

namespace spot {

double largest_weight(const SpotParameters& parameters) {
  const double volume = parameters.critical_fraction > 0.0 ? calibration::most_volume : 1.0;
  return std::max(1.0, parameters.fixed_volume * volume / calibration::least_enclosed);
}

double fixed_volume_weight(const SpotParameters& parameters, double height, int enclosed) {
  if (parameters.fixed_volume == 0.0) return 1.0;
  const double part = parameters.profile->part_above(height / parameters.radius);
  const double grains = static_cast<double>(enclosed) / grain_volume;
  return parameters.fixed_volume * part / std::max(grains, calibration::least_enclosed * part + 1e-9);
}

namespace {

/// Of a grain with this volume_parts() and share of the influence.
int volume_of(int grain, double share) { return static_cast<int>(share * grain); }

}  // namespace

int enclosed_volume(const Packing& packing, const std::vector<std::uint32_t>& grains, const Move& move,
                    const SpotParameters& spots) {
  int enclosed = 0;
  for (const std::uint32_t i : grains) {
    const double squared = packing.distance_squared(i, move.middle);
    if (squared <= spots.radius * spots.radius)
      enclosed += volume_of(packing.volume(i), spots.profile->share(squared, spots.radius));
  }
  return enclosed;
}

int displace(Packing& packing, const std::vector<std::uint32_t>& grains, const Move& move, const SpotParameters& spots,
             MovesReceived* received) {
  const Quantum& quantum = packing.quantum();
  const Vector3 whole = -spots.influence * move.weight * move.step;
  int enclosed = 0;
  for (const std::uint32_t i : grains) {
    const double squared = packing.distance_squared(i, move.middle);
    if (squared > spots.radius * spots.radius) continue;
    const double share = spots.profile->share(squared, spots.radius);
    const Vector3 by = share * whole;
    packing.move(i, quantum.round(by.x()), quantum.round(by.y()), quantum.round(by.z()));
    if (received) ++(*received)[packing.id(i)];
    enclosed += volume_of(packing.volume(i), share);
  }
  return enclosed;
}

}  // namespace spot
