# SPDX-License-Identifier: GPL-2.0-or-later
"""Compare quantities, name -> [value, error], of a reference with those of several runs: what the commands for hoppers, boxes
and mixtures share."""

import argparse
import json
import os
from dataclasses import dataclass
from typing import Callable

from ..base.errors import AnalysisError
from ..report import quantity_table


@dataclass(frozen=True)
class Kind:
    """A kind of scene and how it is measured.

    what : its name; start, end : defaults of --from and --to, in the unit
    measure(folder, start, end) : quantities of dumps; raises ValueError where they do not suffice
    draw(path, reference, spot) : writes the plot, which shows ``drawn``
    """

    what: str
    end: float
    measure: Callable
    draw: Callable
    drawn: str = "profiles of the fall"
    start: float = 10.0
    unit: str = "tau"


def parse_arguments(description, epilog, drawn, start, end, unit="TAU"):
    """drawn : what --plot shows; start, end : defaults of --from and --to, in words"""
    parser = argparse.ArgumentParser(description=description, epilog=epilog)
    parser.add_argument("runs", nargs="+", metavar="RUN",
                        help="folder of dumps with scene.json, or a file of --output; the first is what the others are "
                             "compared with, alone it is measured")
    parser.add_argument("--from", dest="start", type=float, metavar=unit,
                        help=f"default: that of a file of --output, or {start}")
    parser.add_argument("--to", dest="end", type=float, metavar=unit,
                        help=f"default: that of a file of --output, or {end}")
    parser.add_argument("--plot", metavar="FILE.png", help=f"draws {drawn}")
    parser.add_argument("-o", "--output", metavar="FILE.json", help="keeps the statistics of the first run")
    options = parser.parse_args()
    if options.output and not options.output.endswith(".json"):
        parser.error(f"--output '{options.output}' must end in .json")
    if options.plot and len(options.runs) == 1:
        parser.error("--plot compares, so it needs two runs or more")
    return options


def choose_interval(options, kind):
    """Fills in the ends of the interval that were not given: those of the first file of statistics, or the defaults."""
    stored = next((read_stored(run)["interval"] for run in options.runs if is_stored(run)), [kind.start, kind.end])
    options.start = stored[0] if options.start is None else options.start
    options.end = stored[1] if options.end is None else options.end
    if not 0 <= options.start < options.end:
        raise AnalysisError(f"the interval {options.start:g} to {options.end:g} {kind.unit}: "
                            "--from must not be negative, and below --to")


def is_stored(source):
    return source.endswith(".json")


def read_stored(source):
    """The interval and the quantities in a file of --output."""
    try:
        with open(source, encoding="utf-8") as handle:
            stored = json.load(handle)
        (start, end), quantities = stored["interval"], stored["quantities"]
        numbers = {name: [*map(float, quantities[name])] for name in quantities}
        return {"interval": [float(start), float(end)], "quantities": numbers}
    except (ValueError, KeyError, TypeError) as error:
        raise AnalysisError(f"{source}: no statistics of --output ({error})") from error


def statistics(source, options, kind):
    """Quantities of a folder of dumps, by kind.measure, or of a file that --output wrote, whose interval must be the same."""
    if not is_stored(source):
        try:
            return kind.measure(source, options.start, options.end)
        except ValueError as error:
            raise AnalysisError(f"{source}: {error}") from error
    stored = read_stored(source)
    start, end = stored["interval"]
    if [start, end] != [options.start, options.end]:
        raise AnalysisError(f"{source}: holds the interval {start:g} to {end:g} {kind.unit}, "
                            f"not {options.start:g} to {options.end:g}")
    return stored["quantities"]


def keep(quantities, options):
    """In the file of --output, if one was named."""
    if not options.output:
        return
    with open(options.output, "w", encoding="utf-8") as handle:
        json.dump({"interval": [options.start, options.end], "quantities": quantities}, handle, indent=1)
        handle.write("\n")
    print(f"{options.output}: {len(quantities)} quantities, {os.path.getsize(options.output)} bytes")


def compare(options, kind):
    """Measures the runs, all of a Kind, and says what a command says of them."""
    choose_interval(options, kind)
    reference, *runs = [statistics(run, options, kind) for run in options.runs]
    keep(reference, options)
    spot = quantity_table.pooled(runs) if runs else None
    interval = f"{options.start:g} to {options.end:g} {kind.unit}"
    print("\n".join(quantity_table.lines(interval, options.runs[0], reference, spot, len(runs))))
    if options.plot:
        kind.draw(options.plot, reference, spot)
        print(f"{options.plot}: {kind.drawn}")


def run_command(description, kind, epilog="Lengths are in d, times in tau."):
    """What a command does that knows one kind of scene."""
    compare(parse_arguments(description, epilog, kind.drawn, f"{kind.start:g}", f"{kind.end:g}", kind.unit.upper()), kind)
