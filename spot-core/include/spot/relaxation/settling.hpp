// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "spot/packing/tiled_packing.hpp"
#include "spot/relaxation/bearing.hpp"
#include "spot/relaxation/pushes.hpp"

namespace spot {

/// Grains that nothing holds come down until contacts do: they fall, roll and lie, in sweeps in which every grain
/// decides by where all were before, so that order, ranks and threads change nothing; and then press on each other.
class Settling {
 public:
  /// Of a run with this seed. `in_contact`: overlap of grains that bear on each other, in diameters.
  Settling(TiledPacking& packing, std::uint64_t seed, double in_contact, const Container& container, Workers& workers);

  /// Collective. Moves down those that have come and those above who went, or `everybody` that hangs; others stay where
  /// they are. Returns how many grains of all ranks came down.
  std::size_t run(bool everybody);

 private:
  void find_hanging();
  void start_falling(std::uint32_t slot);
  void sweep(int number);
  std::int32_t next_state(std::uint32_t slot, int sweep, Point& step) const;
  void part_from_bearers(std::uint32_t slot, Point& step) const;
  void press_together();
  void take_along_neighbours();
  double part_laid(double down);
  void move(std::uint32_t slot, const Point& by, std::int32_t state);
  void set_state(std::uint32_t slot, std::int32_t state);
  void keep(std::vector<Place>& places, std::int32_t first_state, std::int32_t last_state) const;
  void update();

  TiledPacking& packing_;
  Cells& cells_;
  std::uint64_t seed_;
  double in_contact_;
  const Container& container_;
  Workers& workers_;
  double diameter_;
  Bearing bearing_;
  std::vector<Place>& falling_;  // of grains that come down, and perhaps of others
  std::vector<Place> laid_;      // of those that have, and perhaps of others
  PushedGrains pressed_;
};

}  // namespace spot
