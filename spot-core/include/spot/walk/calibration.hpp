// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

/// Numbers of the spot model that were measured or chosen by what came out, and no parameters: each with its source.
/// What goes with an influence profile is in InfluenceProfile::calibrated().
namespace spot::calibration {

/// Share of the volume that is grains' in dense flow. 2006 counts 81.7 grains within R_s = 2.6 d in its DEM, which
/// is 0.579; DEM runs of this project's silo have 0.574.
constexpr double packing_fraction_of_flow = 0.58;

/// With a fixed volume, a spot that encloses less than this, in grain volumes, displaces as if it enclosed so much:
/// few grains at the surface would be thrown about by all of its volume (2010, section 3.3).
constexpr double least_enclosed = 20.0;

/// Bounds of relative speeds, at which c is 0.35 and 2 times c_0. A choice: in DEM c is 0.02 to 0.04 wherever grains
/// flow, and the law (c / c_0)^2 was not held against anything beyond; a spot must not stand still where it is alone.
constexpr double slowest_relative_speed = 0.125, fastest_relative_speed = 4.0;

/// In the order of time, relative speeds are set anew whenever a spot at v_s has climbed this part of R_s. A choice:
/// far less than the spacing of the lattice on which spots are counted. Windows set them once each.
constexpr double climb_between_settings = 0.1;

}  // namespace spot::calibration
