// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "spot/container.hpp"
#include "spot/packing.hpp"
#include "spot/parameters.hpp"
#include "spot/relaxation.hpp"
#include "spot/spot_population.hpp"

namespace spot {

/// What has happened since the start.
struct Counters {
  std::int64_t moves = 0;             ///< spot steps
  std::int64_t grains_moved = 0;      ///< grains moved by them, each counted every time
  std::int64_t sweeps = 0;            ///< relaxation sweeps
  std::int64_t drained = 0;           ///< grains that left below the outlet

  /// <N>: grains that a move of a spot influences, on average.
  double grains_per_move() const { return moves == 0 ? 0.0 : static_cast<double>(grains_moved) / moves; }
};

/// How a drainage starts and ends.
struct DrainageLimits {
  double outlet;                 ///< grains with centres below this height are taken out (length)
  double largest_overlap = 0.03; ///< allowed in the starting packing, in diameters
};

/// The strictly time-ordered driver of 2006: every step of every spot, in order of time, displaces its
/// block of grains and is followed by a relaxation of the grains around it.
class Drainage {
 public:
  /// Throws InvalidParameter, InvalidContainer or InvalidPacking, naming the grain, if the start is not
  /// valid: grains outside the container or overlapping too deeply, an outlet that newborn spots do not reach.
  Drainage(const SpotParameters& spots, const RelaxationParameters& relaxation, const DrainageLimits& limits,
           std::shared_ptr<const Container> container, Packing packing);

  /// Goes on until `time`, in the units of the rates; births and steps start at time 0.
  void advance_to(double time);

  /// Goes on with other grains or walls, as after somebody else changed them; the spots stay. Throws InvalidPacking
  /// if a grain is outside. How deeply grains overlap is not asked: in flow that is the relaxation's business.
  void replace(std::shared_ptr<const Container> container, Packing packing);

  /// Throws InvalidPacking, naming the grain, if one has left the container other than through the orifice.
  void require_inside() const;

  const Packing& packing() const { return packing_; }
  const std::vector<Spot>& spots() const { return population_.spots(); }
  const Counters& counters() const { return counters_; }
  Overlap largest_overlap();

  /// Grains that left since the last call, where they were then, in increasing order of ids.
  std::vector<Grain> take_drained();

 private:
  void require_valid_start();
  void carry_out(const Move& move);
  void take_out_drained();

  SpotParameters parameters_;
  DrainageLimits limits_;
  std::shared_ptr<const Container> container_;
  Packing packing_;
  SpotPopulation population_;
  Relaxation relaxation_;
  Counters counters_;
  std::vector<Grain> drained_;
  std::vector<std::uint32_t> near_;  // grains around a move; kept to save allocations
};

}  // namespace spot
