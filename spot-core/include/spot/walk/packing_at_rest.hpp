// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "spot/base/vector.hpp"
#include "spot/geometry/container.hpp"
#include "spot/parallel/communicator.hpp"
#include "spot/walk/parameters.hpp"

namespace spot {

/// A grain, as far as a spot that encloses it has to know it.
struct EnclosedGrain {
  Vector3 position;
  int volume;  ///< 1024 = grain_volume
};

/// What spots see in the bulk of a packing before they move it, over the same places.
struct PackingAtRest {
  /// The grain volume that moves would enclose, over what they would enclose at a packing fraction of 1
  /// (CriticalState), each summed over all places.
  double fraction;
  /// The mean critical packing fraction of a flow that walls alone shear (FlowField), phi_c (1 - a kappa / h).
  double critical;
};

/// The packing at rest, and what the critical state would make of it.
///
/// Places are nodes of a NodeLattice, R_s apart, but no closer than grains are: inside the walls, where spots leave
/// volume (calibration::least_height_of_exchange), and with the whole influence two diameters or more below the free
/// surface. None if there are fewer than calibration::least_places_at_rest of them, as in a small heap, or more than
/// grains could fill, as while they fall.
///
/// Collective: `grains` are those of this rank, and the same bits come out on any ranks. The parameters must have a
/// critical packing fraction.
std::optional<PackingAtRest> packing_at_rest(const SpotParameters& parameters, const Container& container,
                                             double diameter, const std::vector<EnclosedGrain>& grains,
                                             Communicator& communicator);

}  // namespace spot
