// SPDX-License-Identifier: GPL-2.0-only
// Prints the version number of the LAMMPS library, as later compared by register_spot().
#define OMPI_SKIP_MPICXX 1
#include "lammps_headers.h"

#include "lammps.h"

#include <mpi.h>
#include <cstdio>

int main(int argc, char **argv) {
  MPI_Init(&argc, &argv);
  {
    const char *options[] = {"lmp", "-screen", "none", "-log", "none", "-nocite"};
    LAMMPS_NS::LAMMPS lammps(6, const_cast<char **>(options), MPI_COMM_WORLD);
    std::printf("lammps version %d\n", lammps.num_ver);
  }
  MPI_Finalize();
  return 0;
}
