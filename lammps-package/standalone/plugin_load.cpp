// SPDX-License-Identifier: GPL-2.0-only
// The entry point that `plugin load` of a LAMMPS with the PLUGIN package looks for.
#include "lammps_headers.h"

#include "fix_spot.h"
#include "lammpsplugin.h"
#include "register_spot.h"
#include "version.h"

#include <cstdio>

using namespace LAMMPS_NS;

static Fix *create_fix_spot(LAMMPS *lmp, int narg, char **arg) { return new FixSpot(lmp, narg, arg); }

extern "C" void lammpsplugin_init(void *lmp, void *handle, void *register_function) {
  if (const char *reason = why_not_for(lmp)) {
    std::fprintf(stderr, "ERROR: %s\n", reason);
    return;
  }
  lammpsplugin_t plugin{};
  plugin.version = LAMMPS_VERSION;
  plugin.style = "fix";
  plugin.name = "spot";
  plugin.info = "drainage of dense grains by diffusing spots of free volume";
  plugin.author = "the authors of fix spot";
  plugin.creator.v2 = reinterpret_cast<lammpsplugin_factory2 *>(&create_fix_spot);
  plugin.handle = handle;
  reinterpret_cast<lammpsplugin_regfunc>(register_function)(&plugin, lmp);
}
