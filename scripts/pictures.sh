#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# Makes the pictures of the documents, where these have them. Runs the decks that are drawn, and ./run.sh where its
# dumps are not there yet.
#
#   scripts/pictures.sh                  all; a quarter of an hour of one core, after ./run.sh
#   scripts/pictures.sh hoppers python   those of these examples
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/.."

all=(silo own-hopper hoppers half-full benchmark-silo bidisperse periodic-slot two-outlets pebble-bed reactor python)
case "${1:-}" in
  -h | --help) sed -n '3,7s/^# \{0,1\}//p' "$0"; exit 0 ;;
esac
[ $# -gt 0 ] || set -- "${all[@]}"
for example in "$@"; do
  [[ " ${all[*]} " == *" $example "* ]] ||
    { echo "pictures.sh: no pictures of '$example', but of ${all[*]}" >&2; exit 2; }
done

scripts/build.sh default lmp
python=$(scripts/python.sh)
analysis() { "$python" -B "analysis/$1.py" "${@:2}" >/dev/null; }
render() { analysis render "$@"; }

# drain EXAMPLE RUN WORDS...: runs the deck of an example with these words; dumps go to results/pictures/EXAMPLE/RUN.
drain() {
  local out=$PWD/results/pictures/$1/$2
  rm -rf "$out"
  mkdir -p "$out"
  (cd "examples/$1" && ../../build/bin/lmp -in in.* -log "$out/log.lammps" -screen none -var out "$out" "${@:3}")
}

pictures_of_silo() {
  local dumps=results/silo/dumps dem=examples/silo/reference
  [ -e "$dumps/scene.json" ] || ./run.sh
  render DEM=$dem/dem-statistics.npz spot=$dumps --times 30 60 90 --height 480 -o docs/pictures/silo.png
  render DEM=$dem/front.npz spot=$dumps --to 90 --height 480 --fps 6 --quality 50 -o docs/pictures/silo.webp
}

pictures_of_own-hopper() {
  local hopper=results/own-hopper
  rm -rf "$hopper"
  mkdir -p "$hopper"
  (cd examples/own-hopper && ../../build/bin/lmp -in in.own -log "../../$hopper/log.lammps" -screen none &&
    mv drain.*.dump scene.json "../../$hopper")
  render DEM=examples/own-hopper/dem.npz spot=$hopper --times 20 40 60 --height 420 -o docs/pictures/hopper.png
}

pictures_of_hoppers() {
  local runs=results/pictures/hoppers here=examples/hoppers
  for seed in 1 2 3; do
    drain hoppers 30-$seed -var angle 30 -var outflow 86.4 -var seed $seed
    drain hoppers 60-$seed -var angle 60 -var outflow 61.4 -var seed $seed
  done
  analysis hopper $here/dem-30.json $runs/30-{1,2,3} --plot $here/profiles-30.png
  analysis hopper $here/dem-60.json $runs/60-{1,2,3} --plot $here/profiles-60.png
}

pictures_of_half-full() {
  local runs=results/pictures/half-full here=examples/half-full
  for seed in 1 2 3; do drain half-full 90-$seed -var outflow 56.1 -var seed $seed; done
  analysis round_heap $here/dem-90.json $runs/90-{1,2,3} --plot $here/drainage-90.png
  render DEM=$here/dem-90.npz spot=$runs/90-1 --slice -1 1 --layer 3 --times 20 60 150 --height 260 -o $here/flat.png
}

pictures_of_benchmark-silo() {
  local runs=results/pictures/benchmark-silo here=examples/benchmark-silo
  for seed in 1 2 3; do drain benchmark-silo $seed -var seed $seed; done
  analysis hopper $here/dem-60.json $runs/{1,2,3} --from 6 --to 24 --plot $here/profiles.png
  render DEM=$here/dem.npz spot=$runs/1 --times 6 14 24 --height 330 -o $here/silo.png
}

pictures_of_bidisperse() {
  local runs=results/pictures/bidisperse here=examples/bidisperse
  for seed in 1 2 3; do drain bidisperse $seed -var ratio 2 -var critical 0.655 -var seed $seed; done
  render DEM=$here/dem.npz spot=$runs/1 --times 10 20 30 --height 300 -o $here/silo-2.png
  analysis mixture $here/dem-2.json $runs/{1,2,3} --plot $here/profiles-2.png
}

pictures_of_periodic-slot() {
  local runs=results/pictures/periodic-slot here=examples/periodic-slot
  for seed in 1 2 3; do drain periodic-slot $seed -var outflow 271 -var tau_run 24 -var seed $seed; done
  analysis box $here/dem.json $runs/{1,2,3} --from 8 --to 22 --plot $here/profiles.png
  render DEM=$here/dem.npz spot=$runs/1 --times 5 10 20 --height 420 -o $here/slot.png
}

pictures_of_two-outlets() {
  local runs=results/pictures/two-outlets here=examples/two-outlets
  for seed in 1 2 3; do drain two-outlets $seed -var outflow 71 -var seed $seed; done
  analysis box $here/dem-left.json $runs/{1,2,3} --from 5 --to 14 --plot $here/profiles-left.png
  analysis box $here/dem-both.json $runs/{1,2,3} --from 31 --to 40 --plot $here/profiles-both.png
  render DEM=$here/dem.npz spot=$runs/1 --times 14 40 --height 300 -o $here/outlets.png
}

pictures_of_pebble-bed() {
  local runs=results/pictures/pebble-bed here=examples/pebble-bed
  for seed in 1 2 3; do drain pebble-bed $seed -var seed $seed; done
  analysis turnovers $here/dem-60.json $runs/{1,2,3} --plot $here/residence.png
  render spot=$runs/1 --layer 5 --slice -1 1 --times 0 92 184 368 --height 330 -o $here/bed.png
  render DEM=$here/dem.npz --height 330 -o $here/bed-dem.png
}

pictures_of_reactor() {
  local here=examples/pebble-bed packing=$PWD/results/pictures/whole-60.data.gz
  mkdir -p results/pictures
  "$python" -B $here/make_packing.py 60 "$packing"
  drain pebble-bed whole -var vessel 29 -var packing "$packing" -var every 40 -var turnovers 0.03
  render spot=results/pictures/pebble-bed/whole --slice -1 1 --times 0 100 200 --height 700 -o $here/reactor.png
  "$python" -c "from PIL import Image
Image.open('$here/reactor.png').convert('RGB').quantize(32).save('$here/reactor.png', optimize=True)"
}

pictures_of_python() {
  scripts/build.sh default spotcore-python
  (cd examples/python && PYTHONPATH=../../build/python MPLBACKEND=Agg "$python" drain_and_plot.py)
  "$python" -c "from PIL import Image
Image.open('examples/python/drain_and_plot.png').convert('RGB').quantize(32).save('docs/pictures/drain_and_plot.png')"
}

mkdir -p docs/pictures
for example in "$@"; do
  echo "== Pictures of $example"
  "pictures_of_$example"
done
