// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/support.hpp"

#include <algorithm>
#include <cmath>

namespace spot {

namespace {

/// Sine of the steepest slope that a grain does not roll down.
constexpr double level = 0.05;

/// Normals at right angles settle at once; those of a narrow wedge take some tens of rounds.
constexpr int rounds = 200;

}  // namespace

/// The way down is the projection of gravity onto the directions that no contact blocks, found by taking from gravity
/// what each contact bears, one after the other and again (Hildreth 1957).
bool holds(const std::vector<Vector3>& normals) {
  Vector3 way(0.0, 0.0, -1.0);
  std::vector<double> borne(normals.size(), 0.0);
  for (int round = 0; round < rounds; ++round) {
    double change = 0.0;
    for (std::size_t k = 0; k < normals.size(); ++k) {
      const double more = std::max(-borne[k], -way.dot(normals[k]));
      borne[k] += more;
      way += more * normals[k];
      change = std::max(change, std::abs(more));
    }
    if (way.norm() < level) return true;
    if (change < 1e-6) break;
  }
  return way.norm() < level;
}

}  // namespace spot
