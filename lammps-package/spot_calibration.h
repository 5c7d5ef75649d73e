// SPDX-License-Identifier: GPL-2.0-only
#ifndef SPOT_CALIBRATION_H
#define SPOT_CALIBRATION_H

/// What commands leave open: numbers that were measured or chosen by what came out. Lengths in diameters. The radius
/// and the momentum go with the influence profile (spot::InfluenceProfile::calibrated()).
namespace calibration {

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
constexpr double climb_in_a_window = 0.32, flow_in_a_window = 0.15;

}  // namespace calibration

#endif
