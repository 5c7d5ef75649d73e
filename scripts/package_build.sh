#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# Makes the package for the Debian that this is.
#
#   scripts/package_build.sh FOLDER    puts it there
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/.."

case "${1:-}" in
  "" | -*) sed -n '3,5s/^# \{0,1\}//p' "$0"; exit 0 ;;
esac

scripts/install-packages.sh g++ cmake ninja-build liblammps-dev lammps libfmt-dev mpi-default-dev libeigen3-dev \
  librandom123-dev python3-dev pybind11-dev dpkg-dev file
scripts/build.sh package
echo "== Making the package"
cpack --config build-package/CPackConfig.cmake -B "$1" >"$1/cpack.log" 2>&1 || { cat "$1/cpack.log" >&2; exit 1; }
rm -rf "$1/_CPack_Packages" "$1/cpack.log"
