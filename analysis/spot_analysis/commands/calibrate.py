# SPDX-License-Identifier: GPL-2.0-or-later
"""Infer the parameters of the spot model, with errors, from the dumps of a DEM run."""

import argparse
import os

from ..base.errors import AnalysisError
from ..calibration.lammps_variables import lammps_variables
from ..calibration.measurement import measure
from ..calibration.parameters import parameters
from ..calibration.refinement import refine
from ..calibration.response import PROFILES, STORED, stored_response
from ..calibration.spreading import warn_of_widening
from ..calibration.view import CONCEPTS
from ..report import calibration_output, calibration_plots
from . import command_line

SOURCES = os.path.join(os.path.dirname(os.path.abspath(__file__)), *3 * [os.pardir])
EXAMPLE = os.path.join(SOURCES, "examples", "silo", "in.silo_spot")


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, epilog="Needs the packing at rest (TIMESTEP 0) and snapshots every 2 tau over at least 24 tau "
        "of steady flow, as dumps with a scene.json beside them. Lengths in grain diameters d, times in tau = sqrt(d/g).")
    parser.add_argument("dumps", metavar="DUMPS", help="folder, file or wildcard of dumps, or statistics of measure.py")
    parser.add_argument("--from", dest="start", type=float, metavar="TAU",
                        help="start of the interval (default: the longest stretch of snapshots from 40 tau on)")
    parser.add_argument("--to", dest="end", type=float, metavar="TAU", help="end of the interval (default: last snapshot)")
    parser.add_argument("-o", "--output", metavar="FILE",
                        help="LAMMPS variables, for 'lmp -in in.silo_spot -var parameters FILE'")
    parser.add_argument("--json", metavar="FILE", help="parameters, all that was measured, and errors")
    parser.add_argument("--plots", metavar="FOLDER", help="a picture of every fit")
    parser.add_argument("--buffer", type=float, default=0.25, metavar="D",
                        help="distance that spot centres keep from side walls, fix spot's 'buffer' (default: %(default)s d)")
    parser.add_argument("--response", choices=sorted(STORED), default="windowed",
                        help="what is taken for the difference between what spots do and what grains show: that of fix "
                        "spot's driver, of spots without relaxation, or none, as 2006 (default: %(default)s)")
    group = parser.add_argument_group("refinement with lmp")
    group.add_argument("--refine", type=int, default=0, metavar="N", help="run the deck N times, correct by what it shows")
    group.add_argument("--lmp", default="lmp", metavar="COMMAND", help="lmp with fix spot (default: %(default)s)")
    group.add_argument("--deck", default=os.path.normpath(EXAMPLE), metavar="FILE", help="(default: examples/silo/in.silo_spot)")
    group.add_argument("--refine-time", type=float, default=90.0, metavar="TAU", help="of each run (default: %(default)g tau)")
    group.add_argument("--fix", default="", metavar="'KEYWORD VALUE ...'", help="more words for fix spot in these runs")
    command_line.add_scene_options(parser)
    return parser.parse_args()


def calibrate():
    options = parse_arguments()
    if options.refine > 0 and not os.path.isfile(options.deck):
        raise AnalysisError(f"{options.deck}: no such deck to refine with; give one with --deck")
    run = command_line.open_run(options.dumps, options, "", "calibrate", CONCEPTS)
    if run.scene.periodic_y:
        raise AnalysisError(f"{options.dumps}: the silo is periodic along y, but parameters are measured between walls there, which "
                            "cut spots off; compare.py and box.py take it")
    measured = measure(run, options.start, options.end, options.buffer)
    warn_of_widening(measured.view, command_line.print_warning)
    response = stored_response(options.response)
    profile = PROFILES.get(options.response, "uniform")
    uncorrected = parameters(measured, stored_response("2006"))
    result = parameters(measured, response)
    if options.refine > 0:
        result, response = refine(
            measured, response, options.refine, options.deck, options.lmp, options.refine_time, options.fix,
            command_line.print_warning, profile=profile)
    span = measured.view.interval.span
    print(f"{span[0]:g} to {span[1]:g} tau, {len(measured.view.snapshots)} snapshots\n")
    print(calibration_output.table(result, uncorrected))
    if options.output:
        write(options.output, lammps_variables(result, options.dumps, span, profile))
    if options.json:
        write(options.json, calibration_output.as_json(measured, result, uncorrected, response, options.dumps))
    if options.plots:
        os.makedirs(options.plots, exist_ok=True)
        for path in calibration_plots.draw(options.plots, measured):
            print(f"plot: {path}")


def write(path, text):
    with open(path, "w", encoding="utf-8") as handle:
        handle.write(text)
    print(f"written: {path}")


def main():
    command_line.run(calibrate)
