// SPDX-License-Identifier: GPL-2.0-only
#ifndef SPOT_GRAIN_SIZES_H
#define SPOT_GRAIN_SIZES_H

#include <cstdint>
#include <string>
#include <vector>

#include "spot/parallel/communicator.hpp"

/// How large the grains of a run are, as they were at its start. Their radii are unequal by a factor of 2 at most.
struct GrainSizes {
  double largest = 0.0;      ///< the largest diameter, the reference diameter of spot-core (length); 0: not known yet
  double mean_volume = 1.0;  ///< of the grains that move, over that of one of the largest: 1/8 to 1

  bool known() const { return largest > 0.0; }
  bool equal() const { return mean_volume == 1.0; }
  /// d of the model: the diameter of a grain of mean volume (length).
  double mean() const;
  /// A grain's radius as spot-core takes it. What is within 1e-5 of the largest is the largest, so that grains whose
  /// diameters were rounded when they were written are equal; in the same way what is half as large.
  double radius(double radius) const { return radius == 0.5 * largest ? radius : rounded(radius); }
  /// Throws spot::InvalidPacking that names the grain unless its radius is from half of the largest to that.
  void require(std::int64_t grain, double radius) const;

 private:
  double rounded(double radius) const;
};

/// Of grains on all ranks, the same on any number of them. `moves`: whether a grain counts for the mean; all do if none
/// does. Collective. A radius that is not finite is left out: require() finds it.
GrainSizes measure_sizes(const std::vector<double> &radii, const std::vector<bool> &moves,
                         spot::Communicator &communicator);

#endif
