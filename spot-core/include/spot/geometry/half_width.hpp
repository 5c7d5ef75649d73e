// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "spot/geometry/container.hpp"

namespace spot {

/// How wide a container is around a place inside, as walls hold up what falls in it: h with
///
///     1 / h = 1 / h_x + 1 / h_y,
///
/// h_x and h_y being half of the free ways along x and along y through the middle of the cross-section: of the way along
/// one axis through the middle of that along the other, twice in turn. In a box and in a cylinder h is the area of the
/// cross-section over its perimeter (Janssen's length), wherever the place is; between two plates it is half of their
/// distance. Ways end at `farthest` on either side, a positive length. Meant for places above the outlets.
double half_width(const Container& container, const Vector3& place, double farthest);

}  // namespace spot
