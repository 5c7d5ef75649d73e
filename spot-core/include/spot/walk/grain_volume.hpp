// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

namespace spot {

/// The volume of a grain of the reference diameter, in the unit in which volumes that moves enclose are summed: whole
/// numbers, so that sums are exact in any order. Each grain counts with its share of the influence, cut to whole units.
constexpr int grain_volume = 1024;

}  // namespace spot
