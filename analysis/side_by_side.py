#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Several runs beside one of DEM, a column each: what one_factor.py tells of a choice, of any runs."""

import argparse

from spot_analysis.base.interpreter import require_packages

require_packages("numpy", "scipy", "matplotlib", "zstandard")

import one_factor  # noqa: E402  (only after the check above)
from spot_analysis.base.errors import AnalysisError  # noqa: E402
from spot_analysis.commands import command_line  # noqa: E402
from spot_analysis.reading.scene import load_scene  # noqa: E402
from spot_analysis.statistics import run_statistics  # noqa: E402
from spot_analysis.statistics.measuring import measure_dumps  # noqa: E402


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("dem", metavar="DEM", help="a folder of dumps, or statistics of measure.py")
    parser.add_argument("columns", nargs="+", metavar="NAME=RUN,RUN...", help="runs that differ by their seeds only")
    parser.add_argument("--from", type=float, dest="start", metavar="TAU", help="beginning of the interval")
    parser.add_argument("--to", type=float, dest="end", metavar="TAU", help="its end")
    return parser.parse_args()


def measured(path):
    """Statistics, from dumps if these are given."""
    if path.endswith(".npz"):
        return run_statistics.load(path)
    return measure_dumps(path, load_scene(path), path, {"source": path}, command_line.print_warning, one_factor.MEASURED)


def read_column(words):
    name, equals, runs = words.partition("=")
    if not (name and equals and runs):
        raise AnalysisError(f"'{words}' is not NAME=RUN,RUN...")
    return name, [measured(run) for run in runs.split(",")]


def main():
    options = parse_arguments()
    dem = measured(options.dem)
    columns = [read_column(words) for words in options.columns]
    rows = {name: [one_factor.rows(dem, run, options.start, options.end) for run in runs] for name, runs in columns}
    found = {name: [{row.name: (row.dem, row.spot) for row in one} for one in runs] for name, runs in rows.items()}
    print("| | DEM | " + " | ".join(found) + " |\n" + "|---" * (len(found) + 2) + "|")
    for name, (heading, factor) in one_factor.QUANTITIES.items():
        dem_value = next(iter(found.values()))[0][name][0]
        cells = [one_factor.text([one[name][1] for one in runs], factor) for runs in found.values()]
        print(f"| {heading} | {one_factor.text([dem_value], factor)} | " + " | ".join(cells) + " |")
    command_line.warn_of_left_out({row.name: row.left_out for runs in rows.values() for one in runs for row in one if row.left_out})


if __name__ == "__main__":
    command_line.run(main)
