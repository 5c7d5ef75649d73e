# SPDX-License-Identifier: GPL-2.0-or-later
"""Compare how grains drain from a box with one or several outlets: DEM and runs of the spot model, quantity by quantity."""

from ..reading.scene import load_scene
from ..report import plots_fall
from ..statistics import box_flow
from . import command_line, quantities


def _measure(folder, start, end):
    scene = load_scene(folder)
    return box_flow.measure(command_line.frames_of_equal_grains(folder, scene), scene, start, end)


def _draw(path, reference, spot):
    plots_fall.save_profiles(path, reference, spot, box_flow.HEIGHTS, "x")


KIND = quantities.Kind("box", 20.0, _measure, _draw)


def main():
    command_line.run(lambda: quantities.run_command(__doc__, KIND))
