// SPDX-License-Identifier: GPL-2.0-only
#ifndef SPOT_GRAIN_DELIVERY_H
#define SPOT_GRAIN_DELIVERY_H

#include <cstdint>
#include <vector>

#include "spot/drivers/drainage.hpp"
#include "spot/parallel/communicator.hpp"

/// Where a grain has gone, for the rank that holds it in LAMMPS' arrays.
struct Delivery {
  std::int64_t id;
  double position[3];
  bool left;  // drained; no position
};

/// Moves that a grain has received.
struct DeliveredMoves {
  std::int64_t id, moves;
};

/// Brings deliveries, of either kind, from the ranks that move the grains to those that hold them: each ID has a third
/// rank, known to all, where both meet. Collective. `held`: IDs of the grains that this rank holds.
/// Throws spot::InvalidPacking that names a grain which nobody holds.
template <typename Parcel>
std::vector<Parcel> deliver(const std::vector<Parcel> &parcels, const std::vector<std::int64_t> &held,
                            spot::Communicator &communicator);

/// What has to be done to the grains of `packing`, each on one rank, for them to be those of `lammps`, each on one
/// rank, too, and perhaps another; positions are compared to the last bit. Collective; every rank gets its own part of
/// the changes. Throws spot::InvalidPacking that names a grain which LAMMPS has twice, or whose radius has changed
/// where it is.
spot::GrainChanges find_changes(const std::vector<spot::Grain> &packing, const std::vector<spot::Grain> &lammps,
                                spot::Communicator &communicator);

#endif
