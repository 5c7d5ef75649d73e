// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cmath>

namespace spot {

/// The length of which all grain positions are multiples.
///
/// Sums of multiples of one power of two are exact in double precision as long as they stay below
/// 2^53 of it, so the order in which displacements are added - of neighbours, cells, lanes or ranks -
/// cannot change a bit of the result.
class Quantum {
 public:
  /// The larger of 2^-bits diameters, rounded down to a power of two, and the spacing of doubles at
  /// `extent`, the largest coordinate (absolute value) that a grain can have. Lengths in deck units.
  /// Throws InvalidParameter unless both are positive and finite and the quantum is below 1e-6 diameters.
  Quantum(double diameter, double extent, int bits = 40);

  double length() const { return length_; }

  /// The nearest multiple, for a displacement: |displacement| < 2^51 quanta (about 2000 diameters).
  /// Adding and subtracting a large multiple rounds without a branch or a call; needs strict
  /// floating point (no -ffast-math).
  double round(double displacement) const { return (displacement + shift_) - shift_; }

  /// The nearest multiple, for a position: |position| up to `extent`.
  double snap(double position) const {
    return std::abs(position) < near_ ? std::copysign(round(position), position) : snap_far(position);
  }

 private:
  double snap_far(double position) const;

  double length_;
  double shift_;
  double near_;  // 2^51 quanta: where a position can be rounded as a displacement
};

}  // namespace spot
