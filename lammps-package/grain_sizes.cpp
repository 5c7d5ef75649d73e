// SPDX-License-Identifier: GPL-2.0-only
#include "grain_sizes.h"

#include <algorithm>
#include <cmath>

#include "spot/base/elementary.hpp"
#include "spot/base/errors.hpp"

namespace {

/// Relative; dumps and data files may have six digits.
constexpr double rounding = 1e-5;

/// The volume of a grain of the largest diameter, in whole numbers, whose sums are exact: of up to 8e9 grains.
constexpr double volume_units = 1 << 30;

bool within_rounding(double value, double other) { return std::abs(value - other) <= rounding * other; }

}  // namespace

double GrainSizes::mean() const { return equal() ? largest : largest * spot::cbrt(mean_volume); }

double GrainSizes::rounded(double radius) const {
  for (const double exact : {0.5 * largest, 0.25 * largest})
    if (within_rounding(radius, exact)) return exact;
  return radius;
}

void GrainSizes::require(std::int64_t grain, double radius) const {
  const double diameter = 2.0 * radius, least = 0.5 * largest;
  if (diameter >= least * (1.0 - rounding) && diameter <= largest * (1.0 + rounding)) return;
  throw spot::InvalidPacking(
      spot::message("grains may have diameters from ", least, " to ", largest,
                    ", the largest at the start, so that none is more than twice as wide as another: grain ", grain,
                    " has ", diameter));
}

GrainSizes measure_sizes(const std::vector<double> &radii, const std::vector<bool> &moves,
                         spot::Communicator &communicator) {
  double largest = 0.0;
  for (const double radius : radii)
    if (std::isfinite(radius)) largest = std::max(largest, 2.0 * radius);
  GrainSizes sizes;
  sizes.largest = -communicator.least(std::vector<double>{-largest})[0];
  if (!sizes.known()) return sizes;
  std::vector<std::int64_t> counts = {0, 0, 0, 0};  // grains that move, all; their volumes
  for (std::size_t k = 0; k < radii.size(); ++k) {
    const double ratio = 2.0 * sizes.radius(radii[k]) / sizes.largest;
    if (!(ratio >= 0.0 && ratio <= 1.0)) continue;
    const auto volume = static_cast<std::int64_t>(std::nearbyint(volume_units * (ratio * ratio * ratio)));
    for (const std::size_t who : {std::size_t{0}, std::size_t{1}}) {
      if (who == 0 && !moves[k]) continue;
      ++counts[who];
      counts[2 + who] += volume;
    }
  }
  counts = communicator.sum(counts);
  const std::size_t who = counts[0] > 0 ? 0 : 1;
  sizes.mean_volume = static_cast<double>(counts[2 + who]) / volume_units / static_cast<double>(counts[who]);
  return sizes;
}
