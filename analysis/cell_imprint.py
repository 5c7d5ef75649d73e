#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Look for an imprint of the cells of the windowed driver in its dumps: number of grains, overlaps and sideways motion against the
distance to the nearest edge of a cell, and, for comparison, in cells of other sizes that the driver knows nothing of."""

import argparse

from spot_analysis.base.interpreter import require_packages

require_packages("numpy", "scipy", "zstandard")

from spot_analysis.base.progress import Progress, share_of  # noqa: E402  (only after the check above)
from spot_analysis.commands import command_line  # noqa: E402
from spot_analysis.reading.dump import find_dumps  # noqa: E402
from spot_analysis.reading.scene import load_scene  # noqa: E402
from spot_analysis.statistics import cell_imprint, fold  # noqa: E402
from spot_analysis.statistics.history import History  # noqa: E402
from spot_analysis.statistics.interval import STEADY_FROM  # noqa: E402
from spot_analysis.statistics.snapshot import LAG_TAU, TIME_TOLERANCE, Snapshot  # noqa: E402

CONTROLS = (1.2, 1.3, 1.4, 1.6, 1.7, 1.8)  # d


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("dumps", nargs="+", metavar="DUMPS", help="folders of runs from the same packing, from the start on")
    parser.add_argument("--from", dest="start", type=float, default=STEADY_FROM, metavar="TAU", help="(default: %(default)g tau)")
    parser.add_argument("--to", dest="end", type=float, default=90.0, metavar="TAU", help="(default: %(default)g tau)")
    return parser.parse_args()


def measure(options):
    measurement = None
    for source in options.dumps:
        scene, progress, history = load_scene(source), Progress(source), History(LAG_TAU)
        container, files = scene.container(), len(find_dumps(source))
        measurement = measurement or cell_imprint.Measurement(container, (cell_imprint.EDGE, *CONTROLS))
        for number, frame in enumerate(command_line.frames_of_equal_grains(source, scene)):
            time = scene.time(frame.timestep)
            snapshot = Snapshot(time, frame.ids, scene.positions(frame.positions), container, None)
            if number == 0:
                measurement.start(snapshot.positions)
            if options.start - TIME_TOLERANCE <= time <= options.end + TIME_TOLERANCE:
                history.add(snapshot)
                measurement.add(snapshot, history.earlier(LAG_TAU))
                progress(f"t = {time:g} tau", share_of(number + 1, files))
    return measurement.imprints()


def main():
    found = measure(parse_arguments())
    print("| axis | quantity | blocks | chi-square (7) | p | rms deviation | of scatter alone | at an edge, in the middle | p in cells of "
          + ", ".join(f"{period:g}" for period in CONTROLS) + " d |\n" + "|---" * 9 + "|")
    for axis in fold.AXES:
        for quantity in cell_imprint.QUANTITIES:
            one = found[axis, cell_imprint.EDGE][quantity]
            deviation, scatter = one.depth()
            controls = ", ".join(f"{found[axis, period][quantity].p_value:.2f}" for period in CONTROLS)
            print(f"| {axis} | {quantity} | {one.blocks} | {one.chi_square:.1f} | {one.p_value:.2g} | {deviation:.4f} | {scatter:.4f} | "
                  f"{one.profile[0]:.3f} +- {one.error[0]:.3f}, {one.profile[-1]:.3f} +- {one.error[-1]:.3f} | {controls} |")


if __name__ == "__main__":
    command_line.run(main)
