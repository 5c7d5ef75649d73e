// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "spot/base/vector.hpp"
#include "spot/geometry/periodic.hpp"
#include "spot/geometry/solid.hpp"

namespace spot {

/// A shape where space repeats. Along each axis of these, one that reaches through the whole cell and is the same
/// everywhere on its way goes on without end; any other becomes three, itself and its images in the cells before and
/// after, which is all that is seen from the cell up to a period away. What `&`, `|` and `~` make of repeated shapes
/// repeats, too. No place of the shape is beyond `low` and `high` (length; they may be infinite).
///
/// Throws InvalidContainer, naming the axis, if a shape that changes along it reaches out of the cell: there it would
/// not meet its image.
Solid repeated(const Solid& shape, const Vector3& low, const Vector3& high, const Periodic& periodic);

}  // namespace spot
