// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>

namespace spot {

/// The five fitted numbers of the spot model and the seed.
/// "2006" is Rycroft, Bazant, Grest, Landry, Phys. Rev. E 73, 051306; "2010" is Rycroft, Wong, Bazant,
/// Powder Technology 200, 1-11. Lengths and times in the units of the deck.
struct SpotParameters {
  double radius = 0.0;          ///< R_s: grains with centres this close to the middle of a step move with it (length)
  double influence = 0.0;       ///< w: a step dr of the spot moves them by -w dr (2006, eq. 1)
  double step_width = 0.0;      ///< dx: a step goes by +-dx along x or along y (length)
  double step_height = 0.0;     ///< dz: and by dz upwards (length)
  double speed = 0.0;           ///< v_s: mean drift speed of a spot (length / time)
  double injection_rate = 0.0;  ///< nu_s: births per time (1 / time)
  std::uint64_t seed = 1;

  /// Steps per time of a spot, v_s / dz; the waiting times are exponential.
  double move_rate() const { return speed / step_height; }
  /// b_s = Var(x) / (2 z) of the walk. Half of the steps go along x, so Var(dx) = dx^2 / 2 a step and
  /// b_s = dx^2 / (4 dz) (length).
  double diffusion_length() const { return step_width * step_width / (4.0 * step_height); }
  /// V_s, the free volume that one spot carries through a packing of this packing fraction (length^3).
  double spot_volume(double packing_fraction) const;

  /// Throws InvalidParameter that names the first number outside its range.
  void validate() const;
};

/// dx that gives a diffusion length b_s with steps of height dz: dx = sqrt(4 b_s dz).
double step_width_for(double diffusion_length, double step_height);

/// Strength of the correction of two overlapping grains that both may move.
enum class RelaxationStrength {
  full_each,  ///< each grain moves alpha delta (as 2006 prints it)
  half_each,  ///< each grain moves alpha delta / 2 (2010)
};

/// The soft-core relaxation of a packing (2006, section IV; 2010, section 2.3).
struct RelaxationParameters {
  double alpha = 0.8;                                           ///< share of an overlap taken back in one sweep
  RelaxationStrength strength = RelaxationStrength::half_each;  ///< who moves how far
  double shell = 1.0;  ///< grains farther than R_s + shell diameters from the step's middle are held fixed
  int every = 1;       ///< time-ordered driver: relax after every so many moves of all spots; 0: never
  /// Windowed driver: rms overlap, in diameters, that moves may build up between sweeps.
  double tolerance = 1.5e-3;

  /// Share of the overlap by which a movable grain moves against another movable grain.
  double pair_share() const { return strength == RelaxationStrength::half_each ? 0.5 * alpha : alpha; }
  /// Share of the overlap by which a movable grain moves against a fixed one or a wall.
  double fixed_share() const { return alpha; }

  /// Throws InvalidParameter that names the first number outside its range.
  void validate() const;
};

}  // namespace spot
