#!/bin/bash
# SPDX-License-Identifier: GPL-2.0-or-later
#
# Drain silos that took no part in the calibration, with the parameters of ../in.silo_spot, and print them beside DEM, beside
# spots that all climb at 3.0 d/tau, and beside two baselines. See README.md.
#
#   ./run.sh [FOLDER]      ten minutes on one core; dumps go to FOLDER (post)
set -euo pipefail

here=$(cd "$(dirname "$0")" && pwd)
root=$here/../../..
analysis=$root/analysis
lmp=${LMP:-$root/build/bin/lmp}
python=$("$root/scripts/python.sh")
out=${1:-post}
mkdir -p "$out"
out=$(cd "$out" && pwd)

# drain FOLDER [-var NAME VALUE]...: seeds 1 to 3
drain() {
  local folder=$1 seed
  shift
  for seed in 1 2 3; do
    echo "$folder, seed $seed" >&2
    (cd "$here/.." && "$lmp" -in in.silo_spot -var seed $seed -var out "$out/$folder.$seed" "$@" -log none -screen "$out/$folder.$seed.screen")
  done
}

# table NAME OUTFLOW FROM TO: DEM in NAME.npz; runs in NAME.SEED and NAME.constant.SEED; OUTFLOW is what grains of the kinematic
# model are given
table() {
  local packing=$out/$1.1/drain.0.dump.zst
  "$python" "$analysis/baseline.py" nothing "$packing" --time "$4" -o "$out/$1.nothing"
  "$python" "$analysis/baseline.py" kinematic "$packing" --time "$4" --outflow "$2" -o "$out/$1.kinematic"
  "$python" "$analysis/side_by_side.py" "$here/$1.npz" "frozen=$out/$1.1,$out/$1.2,$out/$1.3" \
    "constant v_s=$out/$1.constant.1,$out/$1.constant.2,$out/$1.constant.3" "nothing=$out/$1.nothing" "kinematic=$out/$1.kinematic" \
    --from "$3" --to "$4"
}

constant=(-var dilation 0 -var speed 0.514655)   # all spots climb at 3.0 d/tau
walls_16=(-var packing "$here/packing.data.gz" -var half_width 16 -var time 0.88)
orifice_65=("${walls_16[@]}" -var orifice 6.5 -var births 193)   # Beverloo with k = 1.4: ((6.5 - 1.4) / (8 - 1.4))^2.5 of 368 births
tall=(-var packing "$here/tall-packing.data.gz" -var time 0.3147)

drain walls-16 "${walls_16[@]}"
drain walls-16.constant "${walls_16[@]}" "${constant[@]}"
table walls-16 69.6 20 50

drain orifice-6.5 "${orifice_65[@]}"
drain orifice-6.5.constant "${orifice_65[@]}" "${constant[@]}"
table orifice-6.5 36.5 20 50

drain tall "${tall[@]}"
drain tall.constant "${tall[@]}" "${constant[@]}"
table tall 69.6 8 18
