#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# Installs what is needed, builds, drains the silo with the spot model and compares it with the DEM reference.
#
#   ./run.sh                 1.57 s of flow, as in the paper; a few minutes
#   ./run.sh --time 0.2      so many seconds; --seed N: another seed; --threads N: so many threads
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")"

time=1.57
seed=1
threads=1
while [ $# -gt 0 ]; do
  case "$1" in
    --time | --seed | --threads)
      [ $# -ge 2 ] || { echo "run.sh: $1 needs a number" >&2; exit 2; }
      printf -v "${1#--}" '%s' "$2"
      shift ;;
    -h | --help) sed -n '3,7s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) echo "run.sh: unknown option '$1'; allowed are --time SECONDS, --seed N, --threads N" >&2; exit 2 ;;
  esac
  shift
done

[[ "$time" =~ ^[0-9]*\.?[0-9]+$ && "$seed" =~ ^[1-9][0-9]*$ && "$threads" =~ ^[1-9][0-9]*$ ]] || {
  echo "run.sh: --time '$time' must be a positive number of seconds and --seed '$seed' and --threads '$threads' whole numbers" >&2
  exit 2
}

# Ctrl-C ends all of it, whatever the command that it interrupts makes of it.
trap 'trap - INT; kill -INT $$' INT

scripts/install-packages.sh
scripts/build.sh default lmp spotplugin
python=$(scripts/python.sh)

results=$PWD/results/silo
rm -rf "$results"
mkdir -p "$results"
echo "== Draining the silo for $time s of flow with fix spot (seed $seed)"
(cd examples/silo && ../../build/bin/lmp -in in.silo_spot -var time "$time" -var seed "$seed" -var threads "$threads" -var format binary -var out "$results/dumps" \
  -log "$results/log.lammps")
# Every 2 tau, and the packing at the start.
snapshots=$(awk "BEGIN {n = $time / (2 * sqrt(0.003 / 9.81)); k = int(n); print k + (n - k > 1e-6) + 1}")
"$python" scripts/check_snapshots.py "$results/dumps" "$snapshots"

echo "== Comparing with the DEM reference"
# DEM takes some tau to start flowing, which the spot model does not describe: left out of runs that are long enough.
# The whole run is compared over its steady part, as compare.py chooses it.
from=()
if awk "BEGIN {exit !($time >= 0.3 && $time < 1.2)}"; then from=(--from 6); fi
"$python" analysis/compare.py examples/silo/reference/dem-statistics.npz "$results/dumps" "${from[@]}" -o "$results"
