// SPDX-License-Identifier: GPL-2.0-only
// lmp, as the distribution's, with fix spot built in. Takes the same options.
#include "lammps_headers.h"

#include "register_spot.h"

#include "input.h"
#include "lammps.h"

// Newer versions throw at every error, when they have said what it is; older ones end the program by themselves.
#if __has_include("exceptions.h")
#include "exceptions.h"
#else
namespace LAMMPS_NS {
class LAMMPSAbortException {};
class LAMMPSException {};
}  // namespace LAMMPS_NS
#endif

#include <mpi.h>
#include <cstdio>
#include <new>

using namespace LAMMPS_NS;

static void fail(const char *reason) {
  std::fprintf(stderr, "ERROR: %s\n", reason);
  MPI_Abort(MPI_COMM_WORLD, 1);
}

static void run(int argc, char **argv) {
  // Not destroyed after an error, as in LAMMPS' own main().
  auto *lammps = new LAMMPS(argc, argv, MPI_COMM_WORLD);
  if (const char *reason = register_spot(lammps)) fail(reason);
  lammps->input->file();
  delete lammps;
}

int main(int argc, char **argv) {
  MPI_Init(&argc, &argv);
  int status = 0;
  try {
    run(argc, argv);
  } catch (const LAMMPSAbortException &) {  // at an error of one rank
    MPI_Abort(MPI_COMM_WORLD, 1);
  } catch (const LAMMPSException &) {  // of all ranks
    status = 1;
  } catch (const std::bad_alloc &) {  // LAMMPS takes lengths in restart files as they are
    fail("not enough memory, or a restart file that is damaged");
  }
  MPI_Barrier(MPI_COMM_WORLD);
  MPI_Finalize();
  return status;
}
