# SPDX-License-Identifier: GPL-2.0-or-later
"""Compare how a mixture of sizes drains from a flat box: DEM and runs of the spot model, quantity by quantity."""

from ..reading.dump import read_frames
from ..reading.scene import load_scene
from ..report import plots_mixture
from ..statistics import mixture
from ..statistics.passages import ROUNDS
from ..statistics.scene_fit import require_one_round_orifice
from . import command_line, quantities


def _measure(folder, start, end):
    scene = load_scene(folder)
    require_one_round_orifice(scene)
    frames = read_frames(folder, extra=("radius", ROUNDS), warn=command_line.print_warning)
    return mixture.measure(frames, scene, start, end)


KIND = quantities.Kind("mixture", 30.0, _measure, plots_mixture.save,
                       "profiles of the fall, composition of what leaves")
UNITS = "Lengths are in d, that of a grain of mean volume; times in tau."


def main():
    command_line.run(lambda: quantities.run_command(__doc__, KIND, UNITS))
