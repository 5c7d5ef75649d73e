#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# Installs the Debian packages this project needs: those that are missing, and nothing when all are there.
#
#   scripts/install-packages.sh             what run.sh and test.sh need
#   scripts/install-packages.sh NAME ...    these packages instead
set -euo pipefail

packages=(
  g++ cmake ninja-build make
  lammps liblammps-dev libfmt-dev mpi-default-dev mpi-default-bin liggghts
  libeigen3-dev librandom123-dev
  libgtest-dev libgmock-dev libbenchmark-dev
  python3 python3-numpy python3-scipy python3-matplotlib python3-pil python3-zstandard python3-pytest
  python3-venv python3-setuptools python3-wheel
)
[ $# -eq 0 ] || packages=("$@")

missing=()
for package in "${packages[@]}"; do
  [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing+=("$package")
done
[ ${#missing[@]} -gt 0 ] || exit 0

if ! command -v apt-get >/dev/null; then
  echo "install-packages: this needs Debian 12 or 13 (apt-get); elsewhere install what corresponds to: ${missing[*]}" >&2
  exit 1
fi
as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "install-packages: run as root, or install sudo, to install: ${missing[*]}" >&2; exit 1; }
  as_root=(sudo)
fi
echo "== Installing Debian packages: ${missing[*]}"
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
