// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "spot/container.hpp"
#include "spot/displacement.hpp"
#include "spot/parameters.hpp"

namespace spot {

/// One diffusing spot of free volume.
struct Spot {
  std::int64_t id;
  std::int64_t steps;  ///< taken so far
  Vector3 position;
  double next_step;    ///< time of the step to come
};

/// Births, steps and removals of all spots, in order of (time, id).
///
/// A spot is born at the rate nu_s, uniformly on the disc of the orifice's radius less R_s, and R_s below
/// the orifice: it enters the packing with its whole influence, so that as much leaves through the
/// orifice as the spot brings down through any height above (volume closes; see ARCHITECTURE.md).
/// Walks do not look at grains. All randomness follows from (seed, spot id, step number).
class SpotPopulation {
 public:
  /// Throws InvalidParameter, or InvalidContainer if the spots cannot enter.
  SpotPopulation(const SpotParameters& parameters, const Container& container);

  /// The next step of any spot up to and including `time`, or none. The spot has been moved.
  std::optional<Move> next_move(double time, const Container& container);

  /// Removes the spot whose move was handed out last: nothing is left above it.
  void remove_last_moved();

  const std::vector<Spot>& spots() const { return spots_; }
  std::int64_t born() const { return born_; }

 private:
  void give_birth(const Container& container);
  void settle();

  SpotParameters parameters_;
  std::vector<Spot> spots_;  // a heap, earliest next step first; the spot in hand is its last element
  bool in_hand_ = false;     // is the spot that moved last still outside the heap's order?
  double next_birth_;
  std::int64_t born_ = 0;
};

}  // namespace spot
