#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# Installs what is needed, builds and runs all tests, those of spot-core and of the fix once more under sanitizers.
#
#   ./test.sh          everything but the tests labelled slow
#   ./test.sh --slow   those too
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")"

slow=(-LE slow)
case "${1:-}" in
  "") ;;
  --slow) slow=() ;;
  -h | --help) sed -n '3,6s/^# \{0,1\}//p' "$0"; exit 0 ;;
  *) echo "test.sh: unknown option '$1'; allowed is --slow" >&2; exit 2 ;;
esac

scripts/install-packages.sh
scripts/build.sh ci
scripts/build.sh sanitize

echo "== Tests of spot-core and of fix spot under the address and undefined behaviour sanitizers"
ctest --test-dir build-sanitize --output-on-failure --no-tests=error -j "$(nproc)" -L "core|lammps" -LE "slow|statistical"
echo "== All tests"
ctest --test-dir build --output-on-failure --no-tests=error -j "$(nproc)" "${slow[@]}"
