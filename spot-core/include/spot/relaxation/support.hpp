// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <vector>

#include "spot/geometry/container.hpp"

namespace spot {

/// Do contacts with these unit normals, each pointing to the grain, hold it without friction against gravity, which
/// points to -z, even if the ground is tilted a little? Then no way down is open, and the grain is neither on top of
/// another nor on the saddle between two. Ways that are nearly level do not count.
bool holds(const std::vector<Vector3>& normals);

}  // namespace spot
