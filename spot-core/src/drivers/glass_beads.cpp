// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/drivers/glass_beads.hpp"

#include "spot/drivers/defaults.hpp"

namespace spot::glass_beads {

SpotParameters spots(double diameter, double tau) {
  SpotParameters spots;
  spots.profile = InfluenceProfile::parabolic;
  spots.radius = spots.profile->calibrated().radius_in_diameters * diameter;
  spots.step_height = step_height_in_diameters(Accuracy::normal) * diameter;
  spots.step_width = step_width_for(diffusion_length * diameter, spots.step_height);
  spots.influence = 1.5e-3;
  spots.speed = 6.0 * diameter / tau;
  spots.fixed_volume = 77.0;
  spots.critical_fraction = 0.62;
  spots.exchange_length = 0.75 * diameter;
  spots.dilatancy = 0.15 * diameter;
  spots.full_strain = 0.2 / diameter;
  spots.spread = 0.6;
  spots.wall_shear = 0.7;
  spots.surface_exponent = 2.0;
  spots.nonaffine = 0.15;
  spots.nonaffine_length = 0.5 * diameter;
  return spots;
}

RelaxationParameters relaxation() {
  RelaxationParameters relaxation = relaxation_of(Accuracy::normal, *InfluenceProfile::parabolic);
  relaxation.closing_gap = 0.004;
  relaxation.closing_share = 0.15;
  return relaxation;
}

}  // namespace spot::glass_beads
