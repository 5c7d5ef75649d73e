# SPDX-License-Identifier: GPL-2.0-or-later
# A package for the Debian that this is, of what `cmake --install` installs: preset `package`, then `cpack`.
find_program(DPKG_QUERY dpkg-query)
mark_as_advanced(DPKG_QUERY)
if(NOT DPKG_QUERY OR NOT SPOT_LAMMPS OR NOT SPOT_PYTHON_PROGRAM)
  return()
endif()
set(Python_EXECUTABLE ${SPOT_PYTHON_PROGRAM})
find_package(Python REQUIRED COMPONENTS Interpreter)
cmake_host_system_information(RESULT system QUERY DISTRIB_INFO)
# Versions of LAMMPS don't mix: the plugin is for this one alone. Debian 13 calls the library's package liblammps0t64.
execute_process(COMMAND ${DPKG_QUERY} --show "--showformat=\${db:Status-Abbrev}\${Package} (= \${Version})\n" liblammps0*
  OUTPUT_VARIABLE known ERROR_QUIET)
if(NOT known MATCHES "(^|\n)ii (liblammps0[a-z0-9]*) (\\(= [^)]+\\))")
  return()
endif()
set(lammps "${CMAKE_MATCH_2} ${CMAKE_MATCH_3}, lammps ${CMAKE_MATCH_3}")
math(EXPR next_python "${Python_VERSION_MINOR} + 1")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME spot-drainage)
set(CPACK_PACKAGE_CONTACT "The authors of spot-drainage")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Drains silos and hoppers by the spot model, in LAMMPS")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "Drains dense packings of spheres nearly as DEM does, in a small fraction of its
time. Has fix spot, a plugin for Debian's lmp, the C++ library spot-core, the Python module spotcore, commands that
compare, measure, calibrate and draw runs, and examples.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE "1~deb${system_VERSION_ID}")
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
string(JOIN ", " CPACK_DEBIAN_PACKAGE_DEPENDS
  "${lammps}"
  "python3 (>= 3.${Python_VERSION_MINOR})" "python3 (<< 3.${next_python})"
  python3-numpy python3-scipy python3-matplotlib python3-zstandard python3-pil)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "libeigen3-dev")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "ffmpeg, python3-lammps, liggghts")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA
  "${CMAKE_CURRENT_LIST_DIR}/debian/postinst;${CMAKE_CURRENT_LIST_DIR}/debian/prerm")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
include(CPack)
