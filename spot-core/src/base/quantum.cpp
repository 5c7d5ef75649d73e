// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/base/quantum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "spot/base/errors.hpp"

namespace spot {

namespace {

double power_of_two_below(double value) { return std::ldexp(1.0, std::ilogb(value)); }

}  // namespace

Quantum::Quantum(double diameter, double extent, int bits) {
  if (!(diameter > 0.0) || !std::isfinite(diameter))
    throw InvalidParameter(message("grain diameter is ", diameter, " but must be positive and finite"));
  if (!(extent > 0.0) || !std::isfinite(extent))
    throw InvalidParameter(message("extent is ", extent, " but must be positive and finite"));
  const double fine = power_of_two_below(std::ldexp(diameter, -bits));
  // Twice the spacing at the extent: grains pushed a little beyond it still have exact sums.
  const double coarse = 2.0 * power_of_two_below(extent) * std::numeric_limits<double>::epsilon();
  length_ = std::max(fine, coarse);
  if (length_ > 1e-6 * diameter)
    throw InvalidParameter(message("coordinates up to ", extent, " leave only ", length_ / diameter,
                                   " diameters between neighbouring numbers; at most 1e-6 is allowed: move the origin "
                                   "closer to the grains"));
  shift_ = 1.5 * std::ldexp(length_, 52);
  near_ = std::ldexp(length_, 51);
}

double Quantum::snap_far(double position) const { return std::nearbyint(position / length_) * length_; }

}  // namespace spot
