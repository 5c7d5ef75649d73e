# SPDX-License-Identifier: GPL-2.0-or-later
"""Compare how grains drain from a round hopper: DEM and runs of the spot model, quantity by quantity."""

from ..reading.axial_scene import load_axial_scene
from ..report import plots_fall
from ..statistics import axial_flow
from . import command_line, quantities


def _measure(folder, start, end):
    scene = load_axial_scene(folder)
    return axial_flow.measure(command_line.frames_of_equal_grains(folder, scene), scene, start, end)


def _draw(path, reference, spot):
    plots_fall.save_profiles(path, reference, spot, axial_flow.HEIGHTS, "r")


KIND = quantities.Kind("hopper", 50.0, _measure, _draw)


def main():
    command_line.run(lambda: quantities.run_command(__doc__, KIND))
