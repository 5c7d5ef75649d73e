// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/surface.hpp"

#include <cmath>

namespace spot {

double Quadratic::root(bool plus) const {
  const double root = std::sqrt(discriminant()), signed_root = plus ? root : -root;
  if ((half_linear > 0.0) == plus) return constant / (-half_linear - signed_root);
  return (signed_root - half_linear) / squared;
}

Crossings::Crossings(const Quadratic& equation) {
  for (const bool plus : {false, true}) {
    const double s = equation.root(plus);
    if (std::isfinite(s)) at_[static_cast<std::size_t>(size_++)] = s;
  }
}

}  // namespace spot
