// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <memory>

#include "spot/geometry/orifice.hpp"
#include "spot/geometry/spot_buffers.hpp"
#include "spot/geometry/walled_container.hpp"

namespace spot {

/// A silo with four vertical plane walls and a flat base at the height of the orifice's centre.
/// Throws InvalidContainer if the walls are in the wrong order or the orifice reaches beyond them.
std::unique_ptr<WalledContainer> box_silo(double x_low, double x_high, double y_low, double y_high,
                                          const Orifice& orifice, const SpotBuffers& buffers);

/// A silo with an upright cylindrical wall and a flat base at the height of the orifice's centre.
/// Throws InvalidContainer if the orifice reaches beyond the wall.
std::unique_ptr<WalledContainer> cylinder_silo(double x, double y, double radius, const Orifice& orifice,
                                               const SpotBuffers& buffers);

}  // namespace spot
