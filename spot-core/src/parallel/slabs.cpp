// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/parallel/slabs.hpp"

#include <algorithm>
#include <numeric>

namespace spot {

namespace {

/// Sums over the first layers, none to all, as parts of slack times the whole.
std::vector<double> parts_below(const Slabs::Load& load) {
  const auto all = std::accumulate(load.in_layer.begin(), load.in_layer.end(), std::int64_t{0});
  std::vector<double> parts = {0.0};
  std::int64_t below = 0;
  for (const std::int64_t here : load.in_layer)
    parts.push_back(static_cast<double>(below += here) /
                    (load.slack * static_cast<double>(std::max<std::int64_t>(1, all))));
  return parts;
}

std::vector<std::vector<double>> parts_below(const std::vector<Slabs::Load>& loads) {
  std::vector<std::vector<double>> parts;
  for (const Slabs::Load& load : loads) parts.push_back(parts_below(load));
  return parts;
}

double largest_part(const std::vector<std::vector<double>>& below, int first, int last) {
  double largest = 0.0;
  for (const auto& parts : below)
    largest = std::max(largest, parts[static_cast<std::size_t>(last)] - parts[static_cast<std::size_t>(first)]);
  return largest;
}

/// Ends of slabs which, from the bottom, take all layers that keep them within a bound, but leave one for each of the
/// rest.
std::vector<int> fill_up_to(double bound, const std::vector<std::vector<double>>& below, int slabs) {
  const int layers = static_cast<int>(below[0].size()) - 1;
  std::vector<int> first = {0};
  for (int slab = 0; slab + 1 < slabs; ++slab) {
    int end = first.back() + 1;
    while (end < layers - (slabs - slab - 1) && largest_part(below, first.back(), end + 1) <= bound) ++end;
    first.push_back(end);
  }
  first.push_back(layers);
  return first;
}

double largest_part(const std::vector<std::vector<double>>& below, const std::vector<int>& first) {
  double largest = 0.0;
  for (std::size_t slab = 0; slab + 1 < first.size(); ++slab)
    largest = std::max(largest, largest_part(below, first[slab], first[slab + 1]));
  return largest;
}

}  // namespace

Slabs::Slabs(const std::vector<Load>& loads, int ranks) {
  const auto below = parts_below(loads);
  const int layers = static_cast<int>(below[0].size()) - 1, used = std::min(ranks, layers);
  double too_small = 0.0, enough = 1.0;
  first_ = fill_up_to(enough, below, used);
  for (int halving = 0; halving < 30; ++halving) {
    const double bound = 0.5 * (too_small + enough);
    const auto first = fill_up_to(bound, below, used);
    const bool fits = spot::largest_part(below, first) <= bound;
    (fits ? enough : too_small) = bound;
    if (fits) first_ = first;
  }
  first_.resize(static_cast<std::size_t>(ranks) + 1, layers);
}

double Slabs::largest_part(const std::vector<Load>& loads) const {
  return spot::largest_part(parts_below(loads), first_);
}

int Slabs::owner(int layer) const {
  const int inside = std::clamp(layer, 0, layers() - 1);
  const auto next = std::upper_bound(first_.begin(), first_.end(), inside);
  return static_cast<int>(next - first_.begin()) - 1;
}

}  // namespace spot
