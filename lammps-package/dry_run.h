// SPDX-License-Identifier: GPL-2.0-only
#ifndef SPOT_DRY_RUN_H
#define SPOT_DRY_RUN_H

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "spot/geometry/container.hpp"
#include "spot/packing/grain.hpp"
#include "spot_command.h"

/// A drainage as a deck describes it, before its first step. Lengths and times in the units of the deck.
struct DryRun {
  const SpotCommand& command;  // resolved
  std::shared_ptr<const spot::Container> container;
  const std::vector<spot::Grain>& grains;
  double diameter, largest;  // of a grain of mean volume; of the largest, which the library's numbers go by
  double window, timestep;
  std::int64_t steps;  // of the run
  std::string units;
  std::size_t memory;      // of the fix, before the first spot (bytes)
  double low[3], high[3];  // of the simulation box
};

/// As JSON: the numbers above; where walls, grains and outlets are; and what spots do that walk through the packing as
/// it stands. These are born, climb and are reflected as in a run, but move no grain: so live spots, moves a time and
/// the ways that spots go are those of the first steady flow, before the surface has sunk. Takes some seconds.
std::string describe(const DryRun& run);

#endif
