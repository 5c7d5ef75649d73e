#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# Makes all pictures of the documents, in docs/pictures and examples. Takes the dumps of ./run.sh, which runs first where there are none.
#
#   scripts/pictures.sh    # a minute after ./run.sh
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/.."

dumps=results/silo/dumps
[ -e "$dumps/scene.json" ] || ./run.sh
render() { "$(scripts/python.sh)" analysis/render.py "$@"; }
dem=examples/silo/reference
mkdir -p docs/pictures

render DEM=$dem/dem-statistics.npz spot=$dumps --times 30 60 90 --height 480 -o docs/pictures/silo.png
render DEM=$dem/front.npz spot=$dumps --to 90 --height 480 --fps 6 --quality 50 -o docs/pictures/silo.webp

hopper=results/own-hopper
rm -rf "$hopper"
mkdir -p "$hopper"
(cd examples/own-hopper && ../../build/bin/lmp -in in.own -log "../../$hopper/log.lammps" -screen none && mv drain.*.dump "../../$hopper")
cp examples/own-hopper/scene.json "$hopper"
render DEM=examples/own-hopper/dem.npz spot=$hopper --times 20 40 60 --height 420 -o docs/pictures/hopper.png

scripts/build.sh default spotcore-python
python=$(scripts/python.sh)
(cd examples/python && PYTHONPATH=../../build/python MPLBACKEND=Agg "$python" drain_and_plot.py)
"$python" -c "from PIL import Image
Image.open('examples/python/drain_and_plot.png').convert('RGB').quantize(32).save('docs/pictures/drain_and_plot.png')"

# Scenes in boxes: DEM's pictures are kept in their folders.
scene() { # folder, deck, outflow, tau, picture, height, times...
  (cd "examples/$1" && ../../build/bin/lmp -in "$2" -var outflow "$3" -var tau_run "$4" -var out post/1 -log none -screen none)
  render DEM="examples/$1/dem.npz" spot="examples/$1/post/1" --times "${@:7}" --height "$6" -o "examples/$1/$5"
}
scene periodic-slot in.slot 271 24 slot.png 420 5 10 20
scene two-outlets in.two_outlets 71 40 outlets.png 300 14 40
