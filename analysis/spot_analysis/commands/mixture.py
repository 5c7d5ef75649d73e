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
    return mixture.measure(read_frames(folder, extra=("radius", ROUNDS), warn=command_line.print_warning), scene, start, end)


def compare():
    options = quantities.parse_arguments(__doc__, "Lengths are in d, that of a grain of mean volume; times in tau.", end=30.0,
                                         plot="draws profiles of the fall, and the composition of what leaves")
    reference, *runs = [quantities.statistics(run, options, "mixture", _measure) for run in options.runs]
    quantities.keep(reference, options)
    spot = quantities.pooled(runs) if runs else {}
    quantities.print_table(reference, spot, options)
    if options.plot:
        plots_mixture.save(options.plot, reference, spot)
        print(f"{options.plot}: profiles of the fall, composition of what leaves")


def main():
    command_line.run(compare)
