// SPDX-License-Identifier: GPL-2.0-only
// lmp, as the distribution's, with fix spot built in. Takes the same options.
#include "lammps_headers.h"

#include "register_spot.h"

#include "input.h"
#include "lammps.h"

#include <mpi.h>
#include <cstdio>
#include <new>

namespace {

void fail(const char *reason) {
  std::fprintf(stderr, "ERROR: %s\n", reason);
  MPI_Abort(MPI_COMM_WORLD, 1);
}

}  // namespace

int main(int argc, char **argv) {
  MPI_Init(&argc, &argv);
  {
    LAMMPS_NS::LAMMPS lammps(argc, argv, MPI_COMM_WORLD);
    if (const char *reason = register_spot(&lammps)) fail(reason);
    try {
      lammps.input->file();
    } catch (const std::bad_alloc &) {
      // LAMMPS takes lengths in restart files as they are. It is not fit to be taken down then: end before.
      fail("not enough memory, or a restart file that is damaged");
    }
  }
  MPI_Barrier(MPI_COMM_WORLD);
  MPI_Finalize();
  return 0;
}
