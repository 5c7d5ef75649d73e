// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>

#include "spot/base/vector.hpp"
#include "spot/walk/parameters.hpp"

namespace spot {

/// What a grain does against its neighbours while spots move them all (its non-affine motion).
///
/// A move of the influence alone carries whole blocks of R_s. In DEM half of the variance of v_x about the mean flow is
/// single grains' (docs/notes/2026-11-28-non-affine.md). So a grain whose share of a move is f goes by
///
///     -w f (dr + |dz| S t),
///
/// with a vector t of its own: each component uniform, with mean 0 and variance 1. It keeps t while it falls by l, then
/// draws another; where it does so differs from grain to grain. On average grains move as without it, and how far a
/// grain gets depends on how far it falls, not on how fast: it adds S^2 l / 2 to the diffusion length of single grains
/// at most, and less where neighbours are in its way.
class NonaffineMotion {
 public:
  /// t as whole numbers, of which `unit` is one part: |dz| unit x is what is added to dr along x. `level`: in which
  /// draw it is, from 1 on; 0 in a tilt that has not been drawn.
  struct alignas(8) Tilt {
    std::int16_t x, y, z, level;
  };

  explicit NonaffineMotion(const SpotParameters& parameters)
      : strength_(parameters.nonaffine), length_(parameters.nonaffine_length), seed_(parameters.seed) {}

  bool on() const { return strength_ > 0.0; }

  /// Brings the tilt of a grain with its centre at height z up to date. Returns whether it changed.
  bool update(Tilt& tilt, std::int64_t id, double z) const;

  /// S over the numbers in a unit variance.
  double unit() const;

  /// |S t| is at most this.
  double largest() const { return largest(strength_); }
  static double largest(double strength) { return 3.0 * strength; }

 private:
  double strength_, length_;
  std::uint64_t seed_;
};

}  // namespace spot
