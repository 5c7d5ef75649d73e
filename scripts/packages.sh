#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# Makes Debian packages, results/packages/*.deb, each in a Debian of its release, and tries each in a bare one, as a
# user would: installs it, drains a silo by Debian's own lmp, compares, removes it, and looks for what is left.
#
#   scripts/packages.sh          for Debian 12 and 13
#   scripts/packages.sh 12       for this one
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/.."

case "${1:-}" in
  -h | --help) sed -n '3,7s/^# \{0,1\}//p' "$0"; exit 0 ;;
esac
[ $# -gt 0 ] || set -- 12 13

mkdir -p results/packages
for release in "$@"; do
  rm -f results/packages/*"~deb${release}_"*.deb
  scripts/in_debian.sh --share results/packages "$release" scripts/package_build.sh /shared
  deb=$(basename results/packages/*"~deb${release}_"*.deb)
  scripts/in_debian.sh --share results/packages --bare "$release" scripts/package_try.sh "/shared/$deb"
done
