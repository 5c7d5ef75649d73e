# SPDX-License-Identifier: GPL-2.0-or-later
"""Compare how a round bed is turned over, whose grains come in again on top: DEM and runs of the spot model."""

from ..reading.axial_scene import load_axial_scene
from ..report import plots_turnovers
from ..statistics import turnovers
from . import command_line, quantities


def _measure(folder, start, end):
    scene = load_axial_scene(folder)
    return turnovers.measure(command_line.frames_of_equal_grains(folder, scene), scene, start, end)


KIND = quantities.Kind("turned bed", 3.0, _measure, plots_turnovers.save, "residence times and profiles of the fall",
                       start=1.0, unit="turnovers")


def main():
    command_line.run(lambda: quantities.run_command(
        __doc__, KIND, "A turnover is as many grains drained as there are; falls are in d a turnover."))
