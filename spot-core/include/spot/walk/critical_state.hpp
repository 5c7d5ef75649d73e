// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>

#include "spot/geometry/container.hpp"
#include "spot/walk/flow_field.hpp"
#include "spot/walk/move.hpp"
#include "spot/walk/parameters.hpp"

namespace spot {

/// How spots leave volume behind where the packing is too dense for its flow, and take it up where it is too loose.
///
/// In soil mechanics' words, a packing that is sheared long enough comes to its critical state: one packing fraction,
/// whatever it was at rest. DEM's flow does so in every bed. A spot that carries the share V of its volume at birth and
/// climbs by dz through grains whose volume in it is N, each counted by its share of the influence, goes on with
///
///     V exp(-f (dz / l) (N / N_c - 1)),    f = min(1, (e / s_1)^2)
///
/// l being SpotParameters::exchange_length, N_c what it would enclose at phi_c, e the strain there and s_1
/// SpotParameters::full_strain: what comes down as a plug keeps its packing. So volume closes: a move displaces by what
/// its spot carries, and the difference stays in the packing.
class CriticalState {
 public:
  /// `diameter`: the reference diameter.
  CriticalState(const SpotParameters& parameters, double diameter);

  bool on() const { return fraction_ > 0.0; }

  /// N_c: the volume of grains around the middle of a move, each place counted by its share of the influence, if the
  /// packing is critical there up to walls calibration::inset_of_walls farther in; in volumes of a grain. Each wall
  /// cuts off what a plane at its distance would of what others left: exact where no more than one is that near, and
  /// flat. `shear`: s there (1 / length).
  double enclosed(const Vector3& middle, double shear, const Container& container) const;

  /// What the spot of a move carries after it, if it carried `volume` in it and enclosed `enclosed` (1024 =
  /// grain_volume); in whole volume_parts-ths, within calibration's bounds.
  double volume_after(double volume, const Move& move, int enclosed, const Strain& strain,
                      const Container& container) const;

  /// Volumes are whole numbers of this part of a newborn spot's, so that sums of them are exact.
  static constexpr double volume_parts = 1 << 30;

 private:
  double share_exchanged(double strain) const;

  const InfluenceProfile* profile_;
  double radius_, inset_, fraction_, exchange_length_, dilatancy_, full_strain_;
  double enclosed_by_grains_alone_;  // in volumes of a grain, at a packing fraction of 1
};

}  // namespace spot
