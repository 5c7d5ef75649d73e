// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

namespace spot {

/// What has not yet fallen holds spots off: where grains have fallen past a place by H since the start, its mobility is
///
///     m = 1 - (1 - m_0) exp(-H / H_1),
///
/// and spots drift towards what is mobile, by k grad_h ln m for each length that they climb (SpotWalk). So flows begin
/// narrow and widen, as DEM's do: a packing gives way once it is dilated, which takes a strain of 0.5 or a fall of 1 d
/// (docs/notes/2026-11-28-flow-law.md, docs/notes/2026-11-30-mobility.md).
struct Mobility {
  double at_rest = 1.0;  ///< m_0: of what has not fallen, over that of what has fallen far. 1: nothing drifts
  double fall = 0.0;     ///< H_1: with which a packing becomes mobile (length)
  double drift = 0.0;    ///< k: for each length that spots climb, for each e-fold of the mobility (length)

  bool on() const { return at_rest != 1.0; }

  /// ln m. `fallen`: H (length).
  double logarithm(double fallen) const;

  /// Throws InvalidParameter that names the first number outside its range.
  void validate() const;
};

}  // namespace spot
