// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

namespace spot {

/// A place, or a push, as the vector kernels load it: half a cache line.
struct alignas(32) Point {
  double x, y, z;
  double depth;  ///< zero in a place; in a push, the largest 1 - r^2/d^2 of any neighbour
};

}  // namespace spot
