// SPDX-License-Identifier: GPL-2.0-only
#ifndef SPOT_SCENE_FILE_H
#define SPOT_SCENE_FILE_H

#include <cstdint>
#include <string>

#include "spot_command.h"

/// What dumps do not say of a run. Lengths and times in the units of the deck.
struct SceneOfDumps {
  const SpotCommand& command;  // resolved, for the periods of the simulation box
  double diameter;             // of a grain of mean volume
  double gravity, timestep;
  double opening_time;  // of the spots' clock, since step 0
  std::int64_t grains;  // at the start
};

/// A scene.json, as the analysis reads it (analysis/README.md). It tells the walls of a box whose outlets the analysis
/// has words for: equal round holes or slots from side to side, in the middles of equal parts of the base along x; and
/// of a cone under a cylinder about the z axis, with a round outlet at z = 0. Of any other silo it tells units and the
/// place of the first outlet alone.
std::string describe(const SceneOfDumps& scene);

#endif
