# SPDX-License-Identifier: GPL-2.0-or-later
"""Compare quantities, name -> [value, error], of a reference with those of several runs: what the commands for hoppers, boxes
and mixtures share."""

import argparse
import json
import math
import os

from ..base.errors import AnalysisError


def parse_arguments(description, epilog, end, plot):
    """end : default of --to, tau; plot : help of --plot"""
    parser = argparse.ArgumentParser(description=description, epilog=epilog)
    parser.add_argument("runs", nargs="+", metavar="RUN",
                        help="folder of dumps with scene.json, or a file of --output; the first is what the others are compared with")
    parser.add_argument("--from", dest="start", type=float, default=10.0, metavar="TAU", help="default: %(default)g")
    parser.add_argument("--to", dest="end", type=float, default=end, metavar="TAU", help="default: %(default)g")
    parser.add_argument("--plot", metavar="FILE.png", help=plot)
    parser.add_argument("-o", "--output", metavar="FILE.json", help="keeps the statistics of the first run")
    options = parser.parse_args()
    if not 0 <= options.start < options.end:
        parser.error("--from must not be negative, and below --to")
    if options.output and not options.output.endswith(".json"):
        parser.error(f"--output '{options.output}' must end in .json")
    if options.plot and len(options.runs) == 1:
        parser.error("--plot compares, so it needs two runs or more")
    return options


def statistics(source, options, what, measure):
    """Quantities of a folder of dumps, by measure(folder, start, end), or of a file that --output wrote, whose interval must be the
    same. what : these statistics are of."""
    if not source.endswith(".json"):
        try:
            return measure(source, options.start, options.end)
        except ValueError as error:
            raise AnalysisError(f"{source}: {error}") from error
    try:
        with open(source, encoding="utf-8") as handle:
            stored = json.load(handle)
        if stored["interval"] != [options.start, options.end]:
            raise AnalysisError(f"{source}: holds the interval {stored['interval'][0]:g} to {stored['interval'][1]:g} tau, not "
                                f"{options.start:g} to {options.end:g}")
        return stored["quantities"]
    except (ValueError, KeyError, TypeError) as error:
        raise AnalysisError(f"{source}: no statistics of a {what} ({error})") from error


def keep(quantities, options):
    """In the file of --output, if one was named."""
    if not options.output:
        return
    with open(options.output, "w", encoding="utf-8") as handle:
        json.dump({"interval": [options.start, options.end], "quantities": quantities}, handle, indent=1)
        handle.write("\n")
    print(f"{options.output}: {len(quantities)} quantities, {os.path.getsize(options.output)} bytes")


def pooled(runs):
    """Mean over runs, with the standard error over them where there are several."""
    pooled = {}
    for name in runs[0]:
        values = [run.get(name, [math.nan, math.nan]) for run in runs]
        mean = sum(value for value, _ in values) / len(values)
        spread = math.sqrt(sum((value - mean) ** 2 for value, _ in values) / max(len(values) - 1, 1) / len(values))
        pooled[name] = [mean, spread if len(values) > 1 else values[0][1]]
    return pooled


def print_table(reference, spot, options):
    """A row for each quantity of the reference; those that ``spot`` lacks are unknown."""
    heading = [options.runs[0], f"{len(options.runs) - 1} of spot", "difference"]
    print(f"| {options.start:g} to {options.end:g} tau | " + " | ".join(heading) + " |\n|---|---|---|---|")
    for name, value in reference.items():
        print(_row(name, value, spot.get(name, [math.nan, math.nan])))


def _row(name, reference, spot):
    words = [f"{value:.4g} +- {error:.2g}" if math.isfinite(value) else "unknown" for value, error in (reference, spot)]
    known = math.isfinite(reference[0]) and math.isfinite(spot[0]) and reference[0] != 0
    return "| " + " | ".join([name, *words, f"{100 * (spot[0] / reference[0] - 1):+.1f} %" if known else ""]) + " |"


def compare_profiles(description, end, what, measure, draw):
    """What a command does whose plot has profiles of the fall.

    description, end : see parse_arguments; what, measure : see statistics
    draw(path, reference, spot) : writes the plot
    """
    options = parse_arguments(description, "Lengths are in d, times in tau.", end=end, plot="draws the profiles of the fall")
    reference, *runs = [statistics(run, options, what, measure) for run in options.runs]
    keep(reference, options)
    if not runs:
        return
    spot = pooled(runs)
    print_table(reference, spot, options)
    if options.plot:
        draw(options.plot, reference, spot)
        print(f"{options.plot}: profiles of the fall")
