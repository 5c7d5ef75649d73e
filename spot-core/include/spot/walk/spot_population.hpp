// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "spot/base/bytes.hpp"
#include "spot/walk/dilation_field.hpp"
#include "spot/walk/spot_walk.hpp"

namespace spot {

/// Births, steps and removals of all spots, in order of (time, id).
class SpotPopulation {
 public:
  /// Throws InvalidParameter, or InvalidContainer if the spots cannot enter.
  SpotPopulation(const SpotParameters& parameters, const Container& container, double diameter);

  /// A population that goes on from what save() appended.
  SpotPopulation(const SpotParameters& parameters, const Container& container, double diameter, ByteReader& saved);

  void save(Bytes& bytes) const;

  /// The next step of any spot up to and including `time`, or none. The spot has been moved.
  std::optional<Move> next_move(double time, const Container& container);

  /// Removes the spot whose move was handed out last: nothing is left above it.
  void remove_last_moved();

  /// Other walls; the spots stay.
  void replace_container(const Container& container) { dilation_.replace_container(container); }

  const std::vector<Spot>& spots() const { return spots_; }
  std::int64_t born() const { return born_; }

 private:
  void give_birth(const Container& container);
  double next_event() const;
  double next_setting() const;
  void set_paces(double now);
  void settle();

  SpotWalk walk_;
  std::vector<Spot> spots_;  // a heap, earliest next step first; the spot in hand is its last element
  bool in_hand_ = false;     // is the spot that moved last still outside the heap's order?
  double next_birth_;
  std::int64_t born_ = 0;

  // Paces are set at every whole multiple of the interval, if at all; in it a spot climbs a tenth of its radius.
  DilationField dilation_;
  double interval_;
  std::int64_t intervals_ = 0;  // begun
};

}  // namespace spot
