#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-2.0-or-later
# Makes all pictures of the documents, in docs/pictures. Takes the dumps of ./run.sh, which runs first where there are none.
#
#   scripts/pictures.sh
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/.."

dumps=results/silo/dumps
[ -e "$dumps/scene.json" ] || ./run.sh
render() { "$(scripts/python.sh)" analysis/render.py "$@"; }
dem=examples/silo/reference
mkdir -p docs/pictures

render DEM=$dem/dem-statistics.npz spot=$dumps --times 30 60 90 --height 480 -o docs/pictures/silo.png
render DEM=$dem/front.npz spot=$dumps --to 90 --height 480 --fps 6 --quality 50 -o docs/pictures/silo.webp
