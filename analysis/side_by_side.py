#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Runs of any kind judged by family beside DEM, a column each: the table of one_material.py for runs that are there already."""

import argparse

from spot_analysis.base.interpreter import require_packages

require_packages("numpy", "scipy", "matplotlib", "zstandard")

from spot_analysis.base.errors import AnalysisError  # noqa: E402  (only after the check above)
from spot_analysis.commands import command_line  # noqa: E402
from spot_analysis.reading.scene import load_scene  # noqa: E402
from spot_analysis.report import criteria, families, family_table  # noqa: E402
from spot_analysis.statistics import run_statistics  # noqa: E402
from spot_analysis.statistics.interval import STEADY_FROM  # noqa: E402
from spot_analysis.statistics.measuring import measure_dumps  # noqa: E402


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("dem", metavar="DEM[,TWIN...]", help="folders of dumps, or statistics of measure.py; with twins, DEM's value "
                        "is the mean")
    parser.add_argument("columns", nargs="+", metavar="NAME=RUN[,RUN...]", help="runs that differ by their seeds only")
    parser.add_argument("--from", type=float, dest="start", metavar="TAU", help="beginning of the only interval, of steady flow "
                        f"(default: {', '.join(f'{start:g}-{end:g}' for start, end in criteria.WINDOWS.values())} tau, as far as "
                        "the first run of DEM reaches)")
    parser.add_argument("--to", type=float, dest="end", metavar="TAU", help="its end (default: the end of DEM)")
    return parser.parse_args()


def measured(path, times=None):
    """Statistics, from dumps if these are given, at ``times`` only."""
    if path.endswith(".npz"):
        return run_statistics.load(path)
    return measure_dumps(path, load_scene(path), path, {"source": path}, command_line.print_warning, times=times)


def read_column(words):
    name, equals, runs = words.partition("=")
    if not (name and equals and runs):
        raise AnalysisError(f"'{words}' is not NAME=RUN,RUN...")
    return name, runs.split(",")


def main():
    options = parse_arguments()
    columns = dict(map(read_column, options.columns))
    dems = [measured(path) for path in options.dem.split(",")]
    last = dems[0].times[-1]
    windows = criteria.windows_of(last)
    if options.start is not None or options.end is not None:
        windows = {"early": (STEADY_FROM if options.start is None else options.start, last if options.end is None else options.end)}
    verdicts = {name: families.judge(dems, [measured(run, dems[0].times) for run in runs], windows) for name, runs in columns.items()}
    print(f"{family_table.describe(windows)}\n\n{family_table.markdown(family_table.rows(verdicts))}")
    command_line.warn_of_left_out({f"{name}: {criterion.label}": verdict.left_out for name, column in verdicts.items()
                                   for criterion, verdict in column.items() if verdict.left_out})


if __name__ == "__main__":
    command_line.run(main)
