// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>
#include <vector>

namespace spot {

/// Which rank owns which layers of a grid: consecutive layers, from bottom to top. Nothing that is computed depends on
/// where slabs begin.
class Slabs {
 public:
  /// Something that layers have more or less of, and that is to be shared out.
  struct Load {
    std::vector<std::int64_t> in_layer;
    double slack = 1.0;  // times an even part of it is as bad as an even part of a load with slack 1
  };

  /// Slabs whose largest part of any load, over its slack, is as small as it can be. Every rank owns a layer at least;
  /// if there are fewer layers than ranks, the last ranks own none.
  Slabs(const std::vector<Load>& loads, int ranks);
  Slabs(const std::vector<std::int64_t>& in_layer, int ranks) : Slabs(std::vector<Load>{{in_layer}}, ranks) {}

  /// The largest part of any load that a slab has, over its slack.
  double largest_part(const std::vector<Load>& loads) const;

  /// The layers of a rank: from first(rank) to first(rank + 1), exclusive.
  int first(int rank) const { return first_[static_cast<std::size_t>(rank)]; }
  int layers() const { return first_.back(); }
  int ranks() const { return static_cast<int>(first_.size()) - 1; }

  /// The rank that owns a layer; layers beyond the grid belong to the outermost ones.
  int owner(int layer) const;

 private:
  std::vector<int> first_;
};

}  // namespace spot
