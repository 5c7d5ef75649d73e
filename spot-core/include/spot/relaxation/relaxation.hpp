// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "spot/base/memory.hpp"
#include "spot/packing/packing.hpp"
#include "spot/walk/parameters.hpp"

namespace spot {

/// The soft-core relaxation: one simultaneous sweep over some grains, all others fixed.
///
/// Each of the movable grains is pushed along the line of centres by its share of the overlap with every
/// neighbour (RelaxationParameters), and by alpha delta off every wall it overlaps; all pushes are found
/// first and applied at once (2010, section 2.3).
class Relaxation {
 public:
  /// Throws InvalidParameter.
  explicit Relaxation(const RelaxationParameters& parameters);

  const RelaxationParameters& parameters() const { return parameters_; }

  /// The packing's lists must be up to date; no grain may occur twice. Returns the largest overlap of two grains that
  /// it found, over the sum of their radii.
  double sweep(Packing& packing, const Container& container, const std::vector<std::uint32_t>& movable);

  std::size_t memory() const { return bytes_in(is_movable_, pushes_); }

 private:
  struct Push {
    double x = 0.0, y = 0.0, z = 0.0;
  };

  /// Returns the largest overlap with a neighbour, or 0.
  double push_off_neighbours(const Packing& packing, std::uint32_t grain, Push& push) const;
  void push_off_walls(const Packing& packing, const Container& container, std::uint32_t grain, Push& push);

  RelaxationParameters parameters_;
  // Kept between sweeps to save allocations.
  std::vector<char> is_movable_;
  std::vector<Push> pushes_;
  WallContacts contacts_;
};

}  // namespace spot
