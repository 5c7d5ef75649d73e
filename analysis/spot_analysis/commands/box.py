# SPDX-License-Identifier: GPL-2.0-or-later
"""Compare how grains drain from a box with one or several outlets: DEM and runs of the spot model, quantity by quantity."""

from ..reading.scene import load_scene
from ..report import plots_fall
from ..statistics import box_flow
from . import command_line, quantities


def _measure(folder, start, end):
    scene = load_scene(folder)
    return box_flow.measure(command_line.frames_of_equal_grains(folder, scene), scene, start, end)


def compare():
    options = quantities.parse_arguments(__doc__, "Lengths are in d, times in tau.", end=20.0, plot="draws the profiles of the fall")
    reference, *runs = [quantities.statistics(run, options, "box", _measure) for run in options.runs]
    quantities.keep(reference, options)
    if not runs:
        return
    spot = quantities.pooled(runs)
    quantities.print_table(reference, spot, options)
    if options.plot:
        plots_fall.save_profiles(options.plot, reference, spot, box_flow.HEIGHTS, "x")
        print(f"{options.plot}: profiles of the fall")


def main():
    command_line.run(compare)
