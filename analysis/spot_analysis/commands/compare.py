# SPDX-License-Identifier: GPL-2.0-or-later
"""Compare a spot run with a DEM run: one table, comparison.json, plots and a report in HTML."""

import argparse
import os

from ..base.errors import AnalysisError
from ..base.progress import Progress
from ..report import comparison, criteria, families, family_table, table
from ..report.comparison_json import write_json
from ..report.figures import draw_pictures
from ..report.page import write_html
from ..statistics.interval import STEADY_FROM, choose_interval, common_times
from ..statistics.interval_view import IntervalView
from . import command_line


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, epilog="Each run is a statistics file of measure.py (.npz) or a folder, file or wildcard "
        "of dumps with a scene.json beside them. Times are counted from the opening of the orifice.")
    parser.add_argument("dem", metavar="DEM")
    parser.add_argument("spot", metavar="SPOT")
    parser.add_argument("-o", "--output", default="results/silo", metavar="FOLDER", help="(default: %(default)s)")
    parser.add_argument("--from", dest="start", type=float, metavar="TAU",
                        help=f"start of the interval (default: {STEADY_FROM:g} tau, from where flow is "
                        "steady, if both runs are long enough, else the first common time)")
    parser.add_argument("--to", dest="end", type=float, metavar="TAU",
                        help="end of the interval (default: last common time)")
    for prefix in ("dem-", "spot-"):
        command_line.add_scene_options(parser, prefix)
    return parser.parse_args()


def require_all_measured(run, source):
    """one_factor.py stores a part of what is compared here."""
    missing = [name for name, arrays in run.measured.items() if not vars(arrays)]
    if missing:
        raise AnalysisError(f"{source}: the statistics lack {', '.join(missing)}; measure the dumps again with measure.py")


def compare():
    options = parse_arguments()
    dem = command_line.open_run(options.dem, options, "dem-", "DEM")
    spot = command_line.open_run(options.spot, options, "spot-", "spot")
    for run, source in ((dem, options.dem), (spot, options.spot)):
        require_all_measured(run, source)
    dem_common, spot_common = common_times(dem, spot)
    times = dem.times[dem_common]
    interval = choose_interval(times, options.start, options.end)
    views = {"DEM": IntervalView(dem, dem_common, interval),
             "spot": IntervalView(spot, spot_common, interval)}
    rows = comparison.compare(views["DEM"], views["spot"], Progress("numbers"))
    windows = criteria.windows_of(times[-1])
    verdicts = families.judge([dem], [spot], windows)
    by_family = family_table.rows({"spot / DEM": verdicts})

    print(f"common times: {times[0]:g} to {times[-1]:g} tau, {len(times)} snapshots")
    print(table.describe(views["spot"]))
    print()
    print(table.table(rows))
    print()
    print(table.verdict(rows))
    print(f"\nby family, {family_table.describe(windows)}:\n\n{family_table.markdown(by_family)}")
    command_line.warn_of_left_out({row.name: row.left_out for row in rows if row.left_out})

    os.makedirs(options.output, exist_ok=True)
    write_json(os.path.join(options.output, "comparison.json"), rows, views, verdicts)
    pictures = draw_pictures(options.output, views, Progress("pictures"))
    page = os.path.join(options.output, "report.html")
    write_html(page, rows, views, pictures, f"<p>{family_table.describe(windows)}</p>\n{family_table.as_html(by_family)}")
    print(f"\nreport: {page}")


def main():
    command_line.run(compare)
