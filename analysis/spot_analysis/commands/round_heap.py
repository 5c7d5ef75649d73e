# SPDX-License-Identifier: GPL-2.0-or-later
"""Compare how a round container drains to its end, and the heap that stays in it: DEM and runs of the spot model."""

from ..reading.axial_scene import load_axial_scene
from ..report import plots_round_heap
from ..statistics import round_heap
from . import command_line, quantities

MOMENTS = (*(f"{time:g}tau" for time in round_heap.PROFILES), "end")


def _measure(folder, start, end):
    scene = load_axial_scene(folder)
    return round_heap.measure(command_line.frames_of_equal_grains(folder, scene), scene, start, end)


def _draw(path, reference, spot):
    plots_round_heap.save_drainage(path, reference, spot, MOMENTS)


KIND = quantities.Kind("round container", 40.0, _measure, _draw)


def main():
    command_line.run(lambda: quantities.run_command(__doc__, KIND))
