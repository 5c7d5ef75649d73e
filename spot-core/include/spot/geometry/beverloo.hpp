// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

namespace spot {

/// The constants of Beverloo's law: grains leave a deep silo through a hole at the rate C n sqrt(g) times a power of
/// its widths, each less k d; n is the number of grains per volume of the packing, g gravity, d their diameter.
/// Beverloo, Leniger, van de Velde, Chem. Eng. Sci. 15, 260 (1961), for round holes; Nedderman, Statics and Kinematics
/// of Granular Materials (1992), for slots.
struct BeverlooLaw {
  double round = 0.58;  ///< C of a round hole
  double slot = 1.03;   ///< C of a slot
  double margin = 1.4;  ///< k

  /// Holes that are narrower than so many diameters may clog.
  static constexpr double least_width = 6.0;

  /// It holds in silos that are wider than so many widths of the hole, and than the hole by so many diameters.
  static constexpr double least_silo_in_holes = 2.5, least_silo_beyond = 30.0;

  /// And under beds that are deeper than so many widths of the silo, and of the hole.
  static constexpr double least_depth_in_silos = 1.2, least_depth_in_holes = 2.0;
};

}  // namespace spot
