# SPDX-License-Identifier: GPL-2.0-or-later
"""Compare how grains drain from a round hopper: DEM and runs of the spot model, quantity by quantity."""

import argparse
import json
import math
import os

from ..base.errors import AnalysisError
from ..reading.axial_scene import load_axial_scene
from ..report import plots_axial
from ..statistics import axial_flow
from . import command_line
from .quantities import pooled, row


def _statistics(source, start, end):
    """Quantity -> [value, error] of a folder of dumps, or of a file that --output wrote, whose interval must be the same."""
    if not source.endswith(".json"):
        scene = load_axial_scene(source)
        try:
            return axial_flow.measure(command_line.frames_of_equal_grains(source, scene), scene, start, end)
        except ValueError as error:
            raise AnalysisError(f"{source}: {error}") from error
    try:
        with open(source, encoding="utf-8") as handle:
            stored = json.load(handle)
        if stored["interval"] != [start, end]:
            raise AnalysisError(f"{source}: holds the interval {stored['interval'][0]:g} to {stored['interval'][1]:g} tau, not "
                                f"{start:g} to {end:g}")
        return stored["quantities"]
    except (ValueError, KeyError, TypeError) as error:
        raise AnalysisError(f"{source}: no statistics of a hopper ({error})") from error


def compare():
    parser = argparse.ArgumentParser(description=__doc__, epilog="Lengths are in d, times in tau.")
    parser.add_argument("runs", nargs="+", metavar="RUN",
                        help="folder of dumps with scene.json, or a file of --output; the first is what the others are compared with")
    parser.add_argument("--from", dest="start", type=float, default=10.0, metavar="TAU", help="default: %(default)g")
    parser.add_argument("--to", dest="end", type=float, default=50.0, metavar="TAU", help="default: %(default)g")
    parser.add_argument("--plot", metavar="FILE.png", help="draws the profiles of the fall")
    parser.add_argument("-o", "--output", metavar="FILE.json", help="keeps the statistics of the first run")
    options = parser.parse_args()
    if not 0 <= options.start < options.end:
        parser.error("--from must not be negative, and below --to")
    if options.output and not options.output.endswith(".json"):
        parser.error(f"--output '{options.output}' must end in .json")
    if options.plot and len(options.runs) == 1:
        parser.error("--plot compares, so it needs two runs or more")
    runs = [_statistics(run, options.start, options.end) for run in options.runs]
    if options.output:
        with open(options.output, "w", encoding="utf-8") as handle:
            json.dump({"interval": [options.start, options.end], "quantities": runs[0]}, handle, indent=1)
        print(f"{options.output}: {len(runs[0])} quantities, {os.path.getsize(options.output)} bytes")
    if len(runs) > 1:
        spot = pooled(runs[1:])
        print(f"| {options.start:g} to {options.end:g} tau | {options.runs[0]} | {len(runs) - 1} of spot | difference |\n|---|---|---|---|")
        for name, value in runs[0].items():
            print(row(name, value, spot.get(name, [math.nan, math.nan])))
        if options.plot:
            plots_axial.save_profiles(options.plot, runs[0], spot)
            print(f"{options.plot}: profiles of the fall")


def main():
    command_line.run(compare)
