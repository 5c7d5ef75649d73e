// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "packing/kernels.hpp"
#include "spot/packing/cells.hpp"
#include "spot/packing/neighbour_lists.hpp"

namespace spot {

/// What neighbours push n grains by, with the kernel for grains that are equal or that for those that are not.
inline void push_off_neighbours(const kernels::Kernels& kernels, const Cells& cells, const NeighbourLists& lists,
                                const std::uint32_t* grains, std::size_t n, const PushStrength& strength,
                                Point* pushes) {
  const auto pair = static_cast<float>(strength.pair_share), fixed = static_cast<float>(strength.fixed_share);
  const double touch = 1.0 - strength.in_contact, widest = 1.0 + strength.closing_gap / touch;
  const kernels::Gaps gaps = {static_cast<float>(widest * widest - 1.0), static_cast<float>(strength.closing_share)};
  if (cells.unequal()) {
    kernels.push_off_unequal_neighbours(cells.points.data(), cells.sizes.data(), grains, n, lists.view(),
                                        {static_cast<float>(touch), pair, fixed, gaps}, pushes);
    return;
  }
  const double parted = touch * cells.lattice().diameter() / cells.lattice().quantum().length();
  kernels.push_off_neighbours(cells.points.data(), grains, n, lists.view(),
                              {static_cast<float>(1.0 / (parted * parted)), pair, fixed, gaps}, pushes);
}

}  // namespace spot
