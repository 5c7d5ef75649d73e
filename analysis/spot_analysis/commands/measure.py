# SPDX-License-Identifier: GPL-2.0-or-later
"""Measure the dumps of a run and store the statistics, so that compare.py needs no dumps."""

import argparse
import os

from ..report import comparison
from ..statistics.measuring import measure_dumps
from . import command_line


def measure():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("dumps", help="folder, file or wildcard of LAMMPS or LIGGGHTS dumps (text, gzip, zstd, or LAMMPS' binary)")
    parser.add_argument("-o", "--output", required=True, metavar="FILE.npz", help="statistics file to write")
    parser.add_argument("--source", help="where the dumps come from, kept in the file (default: the scene's program)")
    command_line.add_scene_options(parser)
    options = parser.parse_args()
    if not options.output.endswith(".npz"):
        parser.error(f"--output '{options.output}' must end in .npz")
    scene = command_line.scene_from_options(options, options.dumps)
    statistics = measure_dumps(options.dumps, scene, "measure", {"source": options.source or scene.program},
                                        warn=command_line.print_warning)
    statistics.save(options.output)
    print(f"{options.output}: {len(statistics.times)} snapshots, t = {statistics.times[0]:g} to "
          f"{statistics.times[-1]:g} tau, {os.path.getsize(options.output) / 1000:.0f} kB; "
          f"grains outside walls and base: at most {statistics.outside.max()}")
    command_line.warn_of_left_out(comparison.left_out_of(statistics))


def main():
    command_line.run(measure)
