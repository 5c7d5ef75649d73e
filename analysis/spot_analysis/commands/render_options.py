# SPDX-License-Identifier: GPL-2.0-or-later
"""The command line of render.py, and its checks."""

import argparse
import math

from ..base.errors import AnalysisError
from ..rendering import files
from ..rendering.colouring import COLOURINGS
from ..statistics.snapshot import TIME_TOLERANCE

DESCRIPTION = "Draw runs side by side: one picture, PNG frames, an animation (GIF, WebP, MP4), or points for ParaView (VTK)."


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=DESCRIPTION, epilog="RUN is a folder, file or wildcard of LAMMPS or LIGGGHTS dumps, what --keep wrote, or "
        "statistics of measure.py (a picture of the front layer every 10 tau). With a scene.json beside the dumps times are in "
        "tau, and the walls in it, of a box or of a cone under a cylinder, are drawn; without, times are steps.")
    parser.add_argument("runs", nargs="+", metavar="[NAME=]RUN", help="from left to right; snapshots that all of them have are drawn")
    parser.add_argument("-o", "--output", metavar="FILE", help="x.png: all times in one row; x.gif, x.webp, x.mp4: an animation; "
                        "x.vtk: all grains of a single run, a file x.0000.vtk, x.0001.vtk ... a snapshot; without an ending: a "
                        "folder of PNG frames")
    parser.add_argument("--colour", choices=COLOURINGS, default="layer", help="what grains are coloured by (default: %(default)s, the "
                        "layer in which each started; speed: from one snapshot to the next; packing: its share of its Voronoi cell)")
    parser.add_argument("--layer", type=_positive, default=10, metavar="D", help="height of the starting layers (default: %(default)s d)")
    parser.add_argument("--range", nargs=2, type=float, metavar=("LOW", "HIGH"), help="of the colours (default: 98 %% of all values)")
    parser.add_argument("--slice", nargs=2, type=float, metavar=("LOW", "HIGH"), help="draw grains with y between these, in d (default: "
                        "the layer at the front wall, 1 d deep; of other silos, and without scene.json, 2 d in the middle)")
    parser.add_argument("--times", nargs="+", type=float, metavar="T", help="draw these only (tau, or steps without scene.json)")
    parser.add_argument("--from", dest="start", type=float, default=-math.inf, metavar="T")
    parser.add_argument("--to", dest="end", type=float, default=math.inf, metavar="T")
    parser.add_argument("--every", type=int, default=1, metavar="N", help="draw every Nth of these (default: %(default)s)")
    parser.add_argument("--spots", type=_positive, metavar="R", help="draw the middles of live spots, of a 'dump local' in the "
                        "folder, as discs of radius R d, such as 0.4")
    parser.add_argument("--diameter", type=_positive, metavar="D", help="of a grain, in the dumps' units, where neither scene.json nor "
                        "the dumps tell it")
    parser.add_argument("--height", type=int, default=600, metavar="PIXELS", help="of the pictures (default: %(default)s)")
    parser.add_argument("--fps", type=_positive, default=10, metavar="N", help="pictures a second (default: %(default)s)")
    parser.add_argument("--quality", type=int, default=60, metavar="0-100", help="of WebP (default: %(default)s)")
    parser.add_argument("--keep", metavar="FILE.npz", help="of a single run: keep what is drawn, a small RUN for later")
    return parser.parse_args()


def _positive(text):
    value = float(text)
    if not (value > 0 and math.isfinite(value)):
        raise argparse.ArgumentTypeError(f"'{text}' must be a positive number")
    return value


def wanted_times(options):
    """Tells of a time whether it is drawn."""
    def wanted(time):
        near = options.times is None or any(abs(time - one) <= TIME_TOLERANCE for one in options.times)
        return near and options.start - TIME_TOLERANCE <= time <= options.end + TIME_TOLERANCE
    return wanted


def check(options):
    if not (options.output or options.keep):
        raise AnalysisError("give --output or --keep")
    if options.output:
        files.check_output(options.output)
        if options.output.endswith(".vtk") and (len(options.runs) > 1 or options.runs[0].endswith(".npz")):
            raise AnalysisError(f"--output {options.output}: VTK wants the dumps of one run")
    if options.every < 1:
        raise AnalysisError(f"--every {options.every} must be 1 or more")
    if options.keep and (len(options.runs) > 1 or not options.keep.endswith(".npz")):
        raise AnalysisError("--keep wants one run, and a file that ends in .npz")
    for name, pair in (("slice", options.slice), ("range", options.range)):
        if pair and not pair[0] < pair[1]:
            raise AnalysisError(f"--{name} {pair[0]:g} {pair[1]:g}: the first must be below the second")
    if not 100 <= options.height <= 4000:
        raise AnalysisError(f"--height {options.height} must be 100 to 4000 pixels")
