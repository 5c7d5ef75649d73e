// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/packing/displacement.hpp"

#include <algorithm>
#include <cmath>

#include "spot/walk/calibration.hpp"
#include "spot/walk/nonaffine_motion.hpp"

namespace spot {

double largest_weight(const SpotParameters& parameters) {
  return std::max(1.0, parameters.fixed_volume / calibration::least_enclosed);
}

double fixed_volume_weight(const SpotParameters& parameters, double height, int enclosed, double volume) {
  if (parameters.fixed_volume == 0.0) return volume;
  const double part = parameters.profile->part_above(height / parameters.radius);
  const double grains = static_cast<double>(enclosed) / grain_volume / parameters.mean_grain_volume;
  return parameters.fixed_volume * volume * part / std::max(grains, calibration::least_enclosed * volume * part + 1e-9);
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
  const NonaffineMotion motion(spots);
  const double unit = motion.unit() * std::abs(whole.z());
  int enclosed = 0;
  for (const std::uint32_t i : grains) {
    const double squared = packing.distance_squared(i, move.middle);
    if (squared > spots.radius * spots.radius) continue;
    const double share = spots.profile->share(squared, spots.radius);
    Vector3 by = share * whole;
    if (motion.on()) {
      NonaffineMotion::Tilt tilt{};
      motion.update(tilt, packing.id(i), packing.z()[i]);
      by += share * unit * Vector3(tilt.x, tilt.y, tilt.z);
    }
    packing.move(i, quantum.round(by.x()), quantum.round(by.y()), quantum.round(by.z()));
    if (received) ++(*received)[packing.id(i)];
    enclosed += volume_of(packing.volume(i), share);
  }
  return enclosed;
}

}  // namespace spot
