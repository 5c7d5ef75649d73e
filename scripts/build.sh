#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# Configures and builds with a preset of CMakePresets.json; prints little unless something fails.
#
#   scripts/build.sh ci                  everything
#   scripts/build.sh default lmp         only these targets
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/.."
preset=$1
shift
targets=()
[ $# -eq 0 ] || targets=(--target "$@")

echo "== Building (preset $preset)"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
if ! { cmake --preset "$preset" && cmake --build --preset "$preset" "${targets[@]}"; } >"$log" 2>&1; then
  cat "$log" >&2
  exit 1
fi
