// SPDX-License-Identifier: GPL-2.0-or-later
// The installed LAMMPS, with the fix styles of style_fix.h added in the way in which LAMMPS adds its own.
#include "lammps_headers.h"

#include <mpi.h>

#include "input.h"
#include "lammps.h"
#include "modify.h"
#include "style_fix.h"

using namespace LAMMPS_NS;

template <typename Style>
static Fix* create(LAMMPS* lmp, int narg, char** arg) {
  return new Style(lmp, narg, arg);
}

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  {
    LAMMPS lammps(argc, argv, MPI_COMM_WORLD);
#define FIX_CLASS
#define FixStyle(key, Style) (*lammps.modify->fix_map)[#key] = &create<Style>
#include "style_fix.h"
    lammps.input->file();
  }
  MPI_Finalize();
  return 0;
}
