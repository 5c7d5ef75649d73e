# SPDX-License-Identifier: GPL-2.0-or-later
# Installs the documents, which lie towards each other as in the sources.
include(GNUInstallDirs)
set(folder ${CMAKE_INSTALL_DATADIR}/doc/spot-drainage)
install(FILES README.md CHANGELOG.md CITATION.cff DESTINATION ${folder})
install(FILES LICENSE DESTINATION ${folder} RENAME copyright)
install(DIRECTORY docs DESTINATION ${folder} PATTERN site EXCLUDE)
install(FILES analysis/README.md DESTINATION ${folder}/analysis)
install(FILES lammps-package/README.md DESTINATION ${folder}/lammps-package)
install(FILES lammps-package/doc/fix_spot.rst DESTINATION ${folder}/lammps-package/doc)
install(CODE "file(CREATE_LINK ../../spot-drainage/examples
  \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${folder}/examples\" SYMBOLIC)")
