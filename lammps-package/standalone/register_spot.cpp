// SPDX-License-Identifier: GPL-2.0-only
#include "lammps_headers.h"

#include "register_spot.h"

#include "fix_spot.h"
#include "lammps.h"
#include "modify.h"

#include <string>

using namespace LAMMPS_NS;

static Fix *create_fix_spot(LAMMPS *lmp, int narg, char **arg) { return new FixSpot(lmp, narg, arg); }

const char *why_not_for(void *lammps) {
  const auto *lmp = static_cast<const LAMMPS *>(lammps);
  if (lmp->num_ver == SPOT_LAMMPS_VERSION) return nullptr;
  static std::string reason;
  reason = "fix spot was built for LAMMPS version " + std::to_string(SPOT_LAMMPS_VERSION) + ", but this is " +
           std::to_string(lmp->num_ver) + ": build it again for this LAMMPS";
  return reason.c_str();
}

extern "C" const char *register_spot(void *lammps) {
  if (const char *reason = why_not_for(lammps)) return reason;
  (*static_cast<LAMMPS *>(lammps)->modify->fix_map)["spot"] = &create_fix_spot;
  return nullptr;
}
