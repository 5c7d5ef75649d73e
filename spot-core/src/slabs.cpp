// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/slabs.hpp"

#include <algorithm>
#include <numeric>

namespace spot {

Slabs::Slabs(const std::vector<std::int64_t>& grains_in_layer, int ranks) {
  const int layers = static_cast<int>(grains_in_layer.size()), used = std::min(ranks, layers);
  const std::int64_t all = std::accumulate(grains_in_layer.begin(), grains_in_layer.end(), std::int64_t{0});
  std::int64_t below = 0;
  int layer = 0;
  first_.push_back(0);
  for (int rank = 1; rank < used; ++rank) {
    const int least = first_.back() + 1, most = layers - (used - rank);
    // A layer goes to the side where the larger part of it should be.
    while (layer < most &&
           (layer < least || 2 * below + grains_in_layer[static_cast<std::size_t>(layer)] <= 2 * (all * rank / used)))
      below += grains_in_layer[static_cast<std::size_t>(layer++)];
    first_.push_back(layer);
  }
  first_.resize(static_cast<std::size_t>(ranks) + 1, layers);
}

int Slabs::owner(int layer) const {
  const int inside = std::clamp(layer, 0, layers() - 1);
  const auto next = std::upper_bound(first_.begin(), first_.end(), inside);
  return static_cast<int>(next - first_.begin()) - 1;
}

}  // namespace spot
