// SPDX-License-Identifier: GPL-2.0-only
// lmp, as the distribution's, with fix spot built in. Takes the same options.
#include "lammps_headers.h"

#include "register_spot.h"

#include "input.h"
#include "lammps.h"

#include <mpi.h>
#include <cstdio>

int main(int argc, char **argv) {
  MPI_Init(&argc, &argv);
  {
    LAMMPS_NS::LAMMPS lammps(argc, argv, MPI_COMM_WORLD);
    if (const char *reason = register_spot(&lammps)) {
      std::fprintf(stderr, "ERROR: %s\n", reason);
      MPI_Abort(MPI_COMM_WORLD, 1);
    }
    lammps.input->file();
  }
  MPI_Barrier(MPI_COMM_WORLD);
  MPI_Finalize();
  return 0;
}
