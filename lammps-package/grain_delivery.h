// SPDX-License-Identifier: GPL-2.0-only
#ifndef SPOT_GRAIN_DELIVERY_H
#define SPOT_GRAIN_DELIVERY_H

#include <cstdint>
#include <vector>

#include "spot/communicator.hpp"

/// Where a grain has gone, for the rank that holds it in LAMMPS' arrays.
struct Delivery {
  std::int64_t id;
  double position[3];
  bool left;  // drained; no position
};

/// Brings deliveries from the ranks that move the grains to those that hold them: each ID has a third rank, known to
/// all, where both meet. Collective. `held`: IDs of the grains that this rank holds.
/// Throws spot::InvalidPacking that names a grain which nobody holds.
std::vector<Delivery> deliver(const std::vector<Delivery> &deliveries, const std::vector<std::int64_t> &held,
                              spot::Communicator &communicator);

#endif
