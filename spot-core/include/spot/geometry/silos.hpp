// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <memory>
#include <optional>

#include "spot/geometry/outlets.hpp"
#include "spot/geometry/periodic.hpp"
#include "spot/geometry/spot_buffers.hpp"
#include "spot/geometry/walled_container.hpp"

namespace spot {

/// A silo with four vertical plane walls and a flat base at the height of the outlets.
/// Throws InvalidContainer if the walls are in the wrong order or an outlet reaches beyond them.
std::unique_ptr<WalledContainer> box_silo(double x_low, double x_high, double y_low, double y_high,
                                          const Outlets& outlets, const SpotBuffers& buffers);

/// The same with walls at the ends of an interval along x, y or both, and space that repeats along the others. Throws
/// InvalidContainer, besides, if along one there are both or neither.
std::unique_ptr<WalledContainer> box_silo(const std::optional<Interval>& x, const std::optional<Interval>& y,
                                          const Periodic& periodic, const Outlets& outlets, const SpotBuffers& buffers);

/// A silo with an upright cylindrical wall and a flat base at the height of the outlets.
/// Throws InvalidContainer if an outlet reaches beyond the wall, or the wall out of the cell, where space repeats.
std::unique_ptr<WalledContainer> cylinder_silo(double x, double y, double radius, const Outlets& outlets,
                                               const SpotBuffers& buffers, const Periodic& periodic = {});

}  // namespace spot
