# SPDX-License-Identifier: GPL-2.0-only
# The target installed_lammps: LAMMPS::lammps and what its headers need to parse, of any version from 29 Sep 2021 on.
find_package(MPI REQUIRED COMPONENTS C CXX)
find_package(LAMMPS REQUIRED)

# Older ones export the folder that the headers are in, newer ones that above it.
get_target_property(exported LAMMPS::lammps INTERFACE_INCLUDE_DIRECTORIES)
find_path(SPOT_LAMMPS_HEADERS lammps.h PATHS ${exported} PATH_SUFFIXES lammps NO_DEFAULT_PATH REQUIRED)
mark_as_advanced(SPOT_LAMMPS_HEADERS)

add_library(installed_lammps INTERFACE IMPORTED GLOBAL)
target_include_directories(installed_lammps INTERFACE ${SPOT_LAMMPS_HEADERS})
target_compile_definitions(installed_lammps INTERFACE OMPI_SKIP_MPICXX=1)  # or loading fails on MPI::Datatype::Free
target_link_libraries(installed_lammps INTERFACE LAMMPS::lammps MPI::MPI_CXX)
if(NOT EXISTS ${SPOT_LAMMPS_HEADERS}/fmt/format.h)
  find_package(fmt REQUIRED)
  target_compile_definitions(installed_lammps INTERFACE SPOT_LAMMPS_LACKS_FMT)
  target_link_libraries(installed_lammps INTERFACE fmt::fmt-header-only)
endif()
