// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstdint>

/// Numbers of the relaxation in flow that were measured or chosen by what came out, and no parameters: each with its
/// source. Overlaps in diameters.
namespace spot::calibration {

/// Allowed in a starting packing: a choice above the 0.013 that DEM has at most.
constexpr double largest_overlap_at_start = 0.03;

/// What relaxation may leave behind in flow. DEM has 0.013, the spot model 0.03 with the fitted parameters; where it
/// was 0.3, the packing collapsed.
constexpr double largest_overlap_in_flow = 0.3;

/// In a window, a cell with a deeper overlap is relaxed once more, whatever its moves: DEM's deepest
/// is 0.013. Once only: a cell that is swept over and over on its own is pushed into its neighbours.
constexpr double overlap_relaxed_again = 0.02;

/// Most sweeps of a cell in one window; what is left over waits for the next. A choice.
constexpr int most_sweeps_in_a_window = 16;

/// In the order of time, a relaxation that met overlaps below this part of what is allowed in flow needs no check of
/// what it left: pushes that make overlaps much deeper start from deep ones.
constexpr double part_of_overlap_to_check_from = 0.25;

/// How far the grains over the orifice may go in a window, in diameters, on average: farther, and they pass through
/// the base before they are relaxed.
constexpr double longest_flow_in_a_window = 1.0;

/// Windows between checks of the overlaps of all grains, which cost less than 1 % of the run time then.
constexpr std::int64_t windows_between_checks = 64;

/// Windows after which ranks see whether layers should be shared out anew, which takes time itself. A choice.
constexpr std::int64_t windows_between_balances = 16;

}  // namespace spot::calibration
