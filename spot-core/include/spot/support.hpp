// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <vector>

#include "spot/container.hpp"

namespace spot {

/// Do contacts with these unit normals, each pointing to the grain, hold it without friction against gravity, which
/// points to -z? They do if no way down is open: if up is a sum of normals with positive weights. Slopes of less than
/// some three degrees count as level.
bool holds(const std::vector<Vector3>& normals);

}  // namespace spot
