// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <vector>

namespace spot {

/// How the influence of a move falls off with the distance r of a grain's centre from its middle: the grain's share
/// of -w dr, from 0 to 1, and 0 beyond R_s. Everybody who needs a number of the profile asks it here.
///
/// Profiles are the clipped parabolas that the vector kernels evaluate: min(1, (R_s^2 - r^2) per_square), a line in
/// r^2 that is cut at 1. A profile of another form needs kernels of its own.
///
/// To add a profile: a class and its line in all() in influence_profile.cpp, and its name below. Commands take its
/// word from there.
class InfluenceProfile {
 public:
  static const InfluenceProfile* const uniform;    ///< 1 up to R_s (2006, 2010)
  static const InfluenceProfile* const parabolic;  ///< 1 - r^2 / R_s^2: neighbours move by nearly the same

  /// All there are.
  static const std::vector<const InfluenceProfile*>& all();

  /// What kernels evaluate; in the unit of the radius that it was asked with.
  struct ClippedParabola {
    double radius_squared;  ///< R_s^2 (length^2)
    double per_square;      ///< (1 / length^2)
  };

  /// What was chosen for spots of this profile, by measurements.
  struct Calibrated {
    double radius_in_diameters;  ///< R_s of the glass beads of 2006
    /// RelaxationParameters::momentum; the fast one where accuracy is given up for speed. Chosen from the curves of
    /// benchmarks/time_vs_error.py: the largest at which g(r) stays as near to DEM's.
    double momentum, fast_momentum;
  };

  virtual ~InfluenceProfile() = default;

  /// Its word in commands.
  virtual const char* name() const = 0;

  /// Of a grain at this squared distance, which is no more than R_s^2 (dimensionless).
  virtual double share(double distance_squared, double radius) const = 0;

  /// d share / d r there; a jump at R_s itself is no part of it (1 / length).
  virtual double gradient(double distance, double radius) const = 0;

  /// Of a grain anywhere within R_s, on average.
  virtual double mean_share() const = 0;

  /// Its mean square.
  virtual double mean_square_share() const = 0;

  /// Of two grains in touch anywhere within R_s, the mean square of the difference of their shares. `diameter` over
  /// R_s.
  virtual double mean_square_difference(double diameter) const = 0;

  /// The part of a spot's volume, each place counted by its share there, that is above a plane z radii below its
  /// middle; from 0 for z <= -1 to 1 for z >= 1.
  double part_above(double z) const;

  virtual ClippedParabola clipped_parabola(double radius) const = 0;
  virtual Calibrated calibrated() const = 0;

  /// R_s of the uniform spot with the same volume (length).
  double equivalent_radius(double radius) const;

 private:
  /// For z from -1 to 1.
  virtual double part_above_within(double z) const = 0;
};

}  // namespace spot
