// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstddef>

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

/// The free surface is found anew whenever a spot at v_s has climbed this part of R_s. A choice: 0.3 tau with the
/// fitted parameters, in which the surface of the example sinks by 0.05 d, where spots tell heights apart on the scale
/// of R_s. In every window it took 3 to 4 % of a run, when it asked all grains.
constexpr double climb_between_surfaces = 0.5;

/// While a spot at v_s climbs so many R_s, what FlowField remembers of earlier steps falls by a factor of e: 6 tau
/// with the fitted parameters. A choice: long enough for hundreds of steps at each node, short beside the time in which
/// the flow of a silo changes its shape.
constexpr double climb_of_flow_memory = 10.0;

/// Births follow the outflow by half of their rate at most. A choice: DEM's narrowest orifice, 6.5 d wide, needs 1.07.
constexpr double largest_outflow_correction = 0.5;

/// The outflow fades to this share at most: with no births at all nobody would see the bed come back.
constexpr double least_outflow_share = 0.1;

/// Of the length by which the outflow fades, in widths of the outlet. DEM's half-full silo has 1/6; a choice.
constexpr double largest_fade = 2.0;

/// Of 2010's rule for the free surface. It has 3; with more than ten times that, spots only climb the steepest way.
constexpr double largest_surface_exponent = 32.0;

/// Bounds of the critical packing fraction of grains: random loose packings begin at 0.55 with friction, random close
/// ones end at 0.64; a little more on either side for grains of unequal size.
constexpr double least_critical_fraction = 0.5, largest_critical_fraction = 0.7;

/// The least exchange length in steps: with shorter ones a step leaves more than there is too little.
constexpr double least_exchange_in_steps = 0.1;

/// By this share the critical packing fraction may be above that of the packing at rest: with the fitted parameters the
/// mean over the fewest places is uncertain by so much. Beyond, spots take up volume everywhere, and compact what
/// stands. Packings that DEM poured have 0.622 to 0.639 at rest, counted so, where 0.602 is fitted.
constexpr double most_above_rest = 0.01;

/// The packing fraction at rest is told by so many places or not at all. With the fitted parameters a spot at one
/// encloses 80 grains.
constexpr std::size_t least_places_at_rest = 8;

/// The largest dilatancy in R_s. The shear that the lattice of FlowField resolves is at most sqrt(8) over its spacing,
/// sqrt(8) / R_s; from R_s / sqrt(8) on, sheared places would have no critical packing fraction at all.
constexpr double largest_dilatancy = 1.0 / 3.0;

/// The largest strain, times R_s, from which spots exchange volume in full: more than sqrt(12) over its spacing
/// FlowField does not tell, so that they would do so nowhere.
constexpr double largest_full_strain = 3.0;

/// Bounds of the spread and of the shear by walls. DEM's flow has 0.6 and 0.7; choices beyond which nothing was tried.
constexpr double largest_spread = 2.0, largest_wall_shear = 4.0;

/// Of what has not fallen, at least: less would hold spots off for good. A choice; 0.4 was tried.
constexpr double least_mobility = 0.01;

/// So far, in spacings of the lattice, walls are looked for from a node on either side: beyond, they shear next to
/// nothing.
constexpr double farthest_walls = 64.0;

/// A packing's critical packing fraction is counted as if its walls stood so much farther in, in diameters: at this
/// distance a bulk value gives the volumes that moves enclose in DEM's flow within 0.12 %, at any distance from the
/// walls (grains lie in layers there, of which the first is half a diameter from the wall).
constexpr double inset_of_walls = 0.14;

/// So many R_s above the outlets spots leave and take up volume. Below, they converge, and DEM's packing is looser than
/// anywhere else: by 0.03 at 4 to 8 d.
constexpr double least_height_of_exchange = 2.0;

/// A spot that encloses less than this share of what it would at the critical packing fraction is at the surface, not
/// in a loose packing, and takes up nothing.
constexpr double least_share_of_critical = 0.85;

/// Bounds of the volume that a spot carries, over that of a newborn one. One that has left nearly all of it goes on
/// climbing, to make good what others have left too much of. The upper bound is a choice by what came out: with 1.3
/// half of the final flux came to 90 d 4 tau later than in DEM, with 2 and 4 when it does there.
constexpr double least_volume = 0.1, most_volume = 2.0;

/// Of the non-affine motion of grains: with more than 1 / sqrt(3) some of them would rise.
constexpr double largest_nonaffine = 0.5;

}  // namespace spot::calibration
