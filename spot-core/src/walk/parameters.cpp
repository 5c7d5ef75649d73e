// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/walk/parameters.hpp"

#include <cmath>

#include "spot/base/elementary.hpp"
#include "spot/base/errors.hpp"
#include "spot/walk/calibration.hpp"

namespace spot {

namespace {

/// In diameters; far from what makes a packing collapse.
constexpr double largest_contact_overlap = 0.05;

/// Of a grain with half of the reference diameter, the smallest there can be.
constexpr double least_mean_grain_volume = 0.125;

/// In diameters; wider ones are no contacts that moves opened, and lists need a skin beyond them.
constexpr double largest_closing_gap = 0.05;

void require_positive(const char* name, double value) {
  if (!(value > 0.0) || !std::isfinite(value))
    throw InvalidParameter(message(name, " is ", value, " but must be positive and finite"));
}

}  // namespace

double SpotParameters::spot_volume(double packing_fraction) const {
  const double pi = 3.14159265358979323846;
  return influence * profile->mean_share() * packing_fraction * 4.0 / 3.0 * pi * radius * radius * radius;
}

double SpotParameters::missing_volume(double diameter) const {
  const double pi = 3.14159265358979323846;
  return fixed_volume > 0.0 ? influence * fixed_volume * pi / 6.0 * diameter * diameter * diameter * mean_grain_volume
                            : spot_volume(calibration::packing_fraction_of_flow);
}

double SpotParameters::mean_diameter(double diameter) const {
  return mean_grain_volume == 1.0 ? diameter : diameter * cbrt(mean_grain_volume);
}

double SpotParameters::fastest() const { return dilation > 0.0 ? speed * calibration::fastest_relative_speed : speed; }

void SpotParameters::validate() const {
  if (!profile) throw InvalidParameter("spots need an influence profile");
  require_positive("spot radius", radius);
  require_positive("spot influence", influence);
  if (influence >= 1.0) throw InvalidParameter(message("spot influence is ", influence, " but must be below 1"));
  if (!(persistence >= 0.0 && persistence < 1.0))
    throw InvalidParameter(message("spot persistence is ", persistence, " but must be from 0 to below 1"));
  if (!(dilation >= 0.0 && dilation < 1.0))
    throw InvalidParameter(message("spot dilation is ", dilation, " but must be from 0 (off) to below 1"));
  validate_critical_state();
  validate_spread();
  if (!(surface_exponent >= 0.0 && surface_exponent <= calibration::largest_surface_exponent))
    throw InvalidParameter(message("surface exponent is ", surface_exponent, " but must be from 0 (off) to ",
                                   calibration::largest_surface_exponent));
  validate_nonaffine_motion();
  validate_fade();
  if (dilation > 0.0 && together)
    throw InvalidParameter(message("spot dilation is ", dilation, " but must be 0 for spots that step together"));
  require_positive("spot step width", step_width);
  require_positive("spot step height", step_height);
  require_positive("spot speed", speed);
  injection_rate.validate();
  if (!(fixed_volume >= 0.0) || !std::isfinite(fixed_volume))
    throw InvalidParameter(message("fixed volume is ", fixed_volume, " grains but must be zero (off) or positive"));
  if (!(mean_grain_volume >= least_mean_grain_volume && mean_grain_volume <= 1.0))
    throw InvalidParameter(message("mean grain volume is ", mean_grain_volume, " but must be from ",
                                   least_mean_grain_volume, " to 1, that of the largest grains"));
}

void SpotParameters::validate_critical_state() const {
  if (!(dilatancy >= 0.0) || !std::isfinite(dilatancy))
    throw InvalidParameter(message("dilatancy is ", dilatancy, " but must be zero (off) or positive"));
  if (!(full_strain >= 0.0) || !std::isfinite(full_strain))
    throw InvalidParameter(
        message("strain of full exchange is ", full_strain, " but must be zero (full everywhere) or positive"));
  if (critical_fraction == 0.0) {
    if (dilatancy > 0.0)
      throw InvalidParameter(message("dilatancy is ", dilatancy, " but needs a critical packing fraction to lower"));
    if (full_strain > 0.0)
      throw InvalidParameter(message("strain of full exchange is ", full_strain,
                                     " but needs a critical packing fraction that volume is exchanged for"));
    return;
  }
  if (!(full_strain * radius <= calibration::largest_full_strain))
    throw InvalidParameter(message("strain of full exchange is ", full_strain, " but must be at most ",
                                   calibration::largest_full_strain / radius,
                                   ", three over the spot radius: hardly any flow is strained more"));
  if (!(dilatancy <= calibration::largest_dilatancy * radius))
    throw InvalidParameter(message("dilatancy is ", dilatancy, " but must be at most a third of the spot radius, ",
                                   calibration::largest_dilatancy * radius,
                                   ": more leaves no packing fraction where the flow is sheared most"));
  if (!(critical_fraction >= calibration::least_critical_fraction &&
        critical_fraction <= calibration::largest_critical_fraction))
    throw InvalidParameter(message("critical packing fraction is ", critical_fraction, " but must be 0 (off) or from ",
                                   calibration::least_critical_fraction, " to ",
                                   calibration::largest_critical_fraction));
  require_positive("exchange length", exchange_length);
  if (exchange_length < calibration::least_exchange_in_steps * step_height)
    throw InvalidParameter(message("exchange length is ", exchange_length, " but must be at least ",
                                   calibration::least_exchange_in_steps, " of the spots' step height, ", step_height));
  if (fixed_volume == 0.0)
    throw InvalidParameter(message("critical packing fraction is ", critical_fraction,
                                   " but spots carry no fixed volume, of which they could leave some"));
}

void SpotParameters::validate_fade() const {
  if (!(fade >= 0.0 && fade <= calibration::largest_fade))
    throw InvalidParameter(message("fade is ", fade, " but must be from 0 (off) to ", calibration::largest_fade));
  if (fade > 0.0 && !holds_outflow)
    throw InvalidParameter(message("fade is ", fade, " but must be 0 where births do not follow the outflow"));
}

void SpotParameters::validate_spread() const {
  if (!(spread >= 0.0 && spread <= calibration::largest_spread))
    throw InvalidParameter(message("spread is ", spread, " but must be from 0 (off) to ", calibration::largest_spread));
  if (!(wall_shear >= 0.0 && wall_shear <= calibration::largest_wall_shear))
    throw InvalidParameter(message("shear by walls is ", wall_shear, " over their half-width but must be from 0 to ",
                                   calibration::largest_wall_shear));
  if (spread > 0.0 && persistence > 0.0)
    throw InvalidParameter(message("spread is ", spread, " but must be 0 for spots with a persistence, ", persistence));
  if (spread > 0.0 && fixed_volume == 0.0)
    throw InvalidParameter(
        message("spread is ", spread, " but spots carry no fixed volume, by which the flow could be told"));
  mobility.validate();
  if (mobility.on() && spread == 0.0)
    throw InvalidParameter("spots that drift towards what is mobile need a spread, which is 0");
}

void SpotParameters::validate_nonaffine_motion() const {
  if (!(nonaffine >= 0.0 && nonaffine <= calibration::largest_nonaffine))
    throw InvalidParameter(message("non-affine motion is ", nonaffine, " of the fall but must be from 0 (off) to ",
                                   calibration::largest_nonaffine));
  if (nonaffine > 0.0) require_positive("length of non-affine motion", nonaffine_length);
}

double step_width_for(double diffusion_length, double step_height, double persistence) {
  require_positive("spot diffusion length", diffusion_length);
  require_positive("spot step height", step_height);
  return std::sqrt(4.0 * diffusion_length * step_height * (1.0 - persistence) / (1.0 + persistence));
}

void RelaxationParameters::validate() const {
  require_positive("relaxation alpha", alpha);
  if (alpha >= 2.0) throw InvalidParameter(message("relaxation alpha is ", alpha, " but must be below 2"));
  if (!(shell >= 0.0) || !std::isfinite(shell))
    throw InvalidParameter(message("relaxation shell is ", shell, " but must be zero or positive"));
  if (every < 0) throw InvalidParameter(message("relaxation interval is ", every, " but must be zero (never) or more"));
  if (!(momentum >= 0.0 && momentum < 1.0))
    throw InvalidParameter(message("relaxation momentum is ", momentum, " but must be from 0 to below 1"));
  if (!(contact_overlap >= 0.0 && contact_overlap <= largest_contact_overlap))
    throw InvalidParameter(message("overlap in contact is ", contact_overlap, " diameters but must be from 0 to ",
                                   largest_contact_overlap));
  if (!(closing_gap >= 0.0 && closing_gap <= largest_closing_gap))
    throw InvalidParameter(
        message("gap that is closed is ", closing_gap, " diameters but must be from 0 (off) to ", largest_closing_gap));
  if (!(closing_share >= 0.0 && closing_share <= 1.0))
    throw InvalidParameter(
        message("share by which gaps are closed is ", closing_share, " but must be from 0 (off) to 1"));
}

}  // namespace spot
