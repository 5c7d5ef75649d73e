// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>

namespace spot {

/// Consecutive cells along x, by their numbers among those held: from `first` to `last`, exclusive.
struct CellRow {
  std::uint32_t first, last;
};

/// Rows along x: of the layers held from `first_layer` to `last_layer`, exclusive, with images of cells or without;
/// and of them those of one part. Next to each other, in a layer or above, are rows of different parts.
struct RowsAsked {
  int first_layer, last_layer;
  bool with_images = false;
  int part = 0, parts = 1;

  bool contain(int y, int z) const { return (y + z + parts) % parts == part; }  // y = -1: images
};

}  // namespace spot
