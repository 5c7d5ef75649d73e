#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# Configures and builds with a preset of CMakePresets.json; prints little unless something fails.
#
#   scripts/build.sh ci                  everything
#   scripts/build.sh default lmp         only these targets
#   scripts/build.sh sanitize            with the compiled tests of folder `build`, if that is there
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/.."
preset=$1
shift
settings=() targets=()
if [ "$preset" = sanitize ] && [ -e build/CMakeCache.txt ]; then settings=(-D "SPOT_TESTS_OF=$PWD/build"); fi
[ $# -eq 0 ] || targets=(--target "$@")

echo "== Building (preset $preset)"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
if ! { cmake --preset "$preset" "${settings[@]}" && cmake --build --preset "$preset" "${targets[@]}"; } >"$log" 2>&1; then
  cat "$log" >&2
  exit 1
fi
