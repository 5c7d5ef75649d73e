// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "spot/geometry/beverloo.hpp"
#include "spot/geometry/hole.hpp"
#include "spot/geometry/outlets.hpp"
#include "spot/walk/parameters.hpp"

/// What users leave open: numbers that were measured or chosen by what came out. Lengths in diameters. The radius and
/// the momentum go with the influence profile (spot::InfluenceProfile::calibrated()).
namespace spot::calibration {

/// w: 2006's, of its DEM of glass beads.
constexpr double influence = 2.5e-3;

/// b_s; 2006 has 1.14 for its DEM.
constexpr double diffusion_length = 1.25;

/// Of spots from side walls and from the base, from runs with one of them changed at a time
/// (docs/notes/2026-11-23-side-walls.md, 2026-11-22-volume-at-the-orifice.md).
constexpr double side_buffer = 0.25, base_buffer = 2.0;

/// Longest windows, by the climb of a spot and by the flow of grains through the orifice: longer ones relax more of the
/// neighbouring cells at the same time, which is both cheaper and closer to DEM, until grains go too far in one
/// (analysis/one_factor.py, its windows).
constexpr double climb_in_a_window = 0.6, flow_in_a_window = 0.15;

}  // namespace spot::calibration

namespace spot {

/// What everything that is left open is chosen for.
enum class Accuracy {
  fast,    ///< overlaps up to several times those of DEM
  normal,  ///< overlaps no larger than those of DEM
  exact,   ///< as 2006: small steps in the order of time, relaxation after each
};

double step_height_in_diameters(Accuracy accuracy);
RelaxationParameters relaxation_of(Accuracy accuracy, const InfluenceProfile& profile);

/// The longest window that these spots should have (time), by calibration::climb_in_a_window and flow_in_a_window.
/// `diameter`: of a grain of mean volume; `largest`: of the largest one, by which the library counts.
double longest_window(const SpotParameters& spots, double diameter, double largest, const Outlets& outlets);

/// By Beverloo's law, the grains that leave through a hole per time; 0 where it is too narrow. Grains are taken to fill
/// calibration::packing_fraction_of_flow. `gravity` in length / time^2.
double predicted_outflow(const Hole& hole, const BeverlooLaw& law, double gravity, double diameter);

/// The births of spots per time that bring down so many grains per time.
double births_for(double outflow, const SpotParameters& spots, double diameter);

/// The births of spots per time with which the fastest of them carry away, in any height, all grains that are on a
/// cross-section of this area (length^2) at calibration::packing_fraction_of_flow. No flow has more.
double births_that_empty(double area, const SpotParameters& spots, double diameter);

}  // namespace spot
