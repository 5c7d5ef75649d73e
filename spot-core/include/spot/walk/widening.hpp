// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

namespace spot {

/// How a flow widens as its bed goes on falling: by how much its own shear, |grad_h u| / u, counts in how far free
/// volume spreads (SpotWalk), at a place which grains have fallen past by H since the start,
///
///     g_1 + (g_0 - g_1) exp(-H / H_0).
///
/// In DEM's flow free volume spreads the less where grains have fallen by a few diameters only, and the more where they
/// have fallen far, all the more so the stronger the shear (docs/notes/2026-11-30-widening.md).
struct Widening {
  double at_first = 1.0;  ///< g_0: where nothing has fallen yet
  double later = 1.0;     ///< g_1: where grains have fallen far
  double length = 0.0;    ///< H_0: of the fall with which one becomes the other (length)

  bool on() const { return at_first != 1.0 || later != 1.0; }

  /// On the flow's own shear. `fallen`: H (length).
  double factor(double fallen) const;

  /// Throws InvalidParameter that names the first number outside its range.
  void validate() const;
};

}  // namespace spot
