# SPDX-License-Identifier: GPL-2.0-only
# For a LAMMPS source tree, where it goes to cmake/Modules/Packages (../README.md): what the package SPOT needs apart
# from its sources. CMAKE_PREFIX_PATH says where spot-core is, unless it was installed to a usual place.
find_package(spot-core REQUIRED)  # also makes the compiler one of C++17
target_link_libraries(lammps PRIVATE spot-core::spot-core)

# The same bits as from the plugin, whatever processor LAMMPS is compiled for.
file(GLOB spot_sources ${LAMMPS_SOURCE_DIR}/SPOT/*.cpp)
set_source_files_properties(${spot_sources} PROPERTIES COMPILE_OPTIONS -ffp-contract=off)
