# SPDX-License-Identifier: GPL-2.0-or-later
"""Draw runs side by side: one picture, PNG frames, or an animation (GIF, WebP, MP4)."""

import argparse
import math
import os

from ..base.errors import AnalysisError
from ..base.progress import Progress
from ..rendering import files
from ..rendering.colouring import COLOURINGS
from ..rendering.drawing import draw, view_of
from ..rendering.pictures import at_common_times, load_pictures, save_pictures, take_pictures
from ..rendering.source import Run
from ..statistics.snapshot import TIME_TOLERANCE
from . import command_line


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, epilog="RUN is a folder, file or wildcard of LAMMPS or LIGGGHTS dumps, what --keep wrote, or statistics of "
        "measure.py (a picture of the front layer every 10 tau). With a scene.json beside the dumps times are in tau, and walls are "
        "drawn; without, times are steps.")
    parser.add_argument("runs", nargs="+", metavar="[NAME=]RUN", help="from left to right; snapshots that all of them have are drawn")
    parser.add_argument("-o", "--output", metavar="FILE", help="x.png: all times in one row; x.gif, x.webp, x.mp4: an animation; "
                        "without an ending: a folder of PNG frames")
    parser.add_argument("--colour", choices=COLOURINGS, default="layer", help="what grains are coloured by (default: %(default)s, the "
                        "layer in which each started; speed: from one snapshot to the next; packing: its share of its Voronoi cell)")
    parser.add_argument("--layer", type=_positive, default=10, metavar="D", help="height of the starting layers (default: %(default)s d)")
    parser.add_argument("--range", nargs=2, type=float, metavar=("LOW", "HIGH"), help="of the colours (default: 98 %% of all values)")
    parser.add_argument("--slice", nargs=2, type=float, metavar=("LOW", "HIGH"), help="draw grains with y between these, in d (default: "
                        "the layer at the front wall, 1 d deep; without scene.json 2 d in the middle)")
    parser.add_argument("--times", nargs="+", type=float, metavar="T", help="draw these only (tau, or steps without scene.json)")
    parser.add_argument("--from", dest="start", type=float, default=-math.inf, metavar="T")
    parser.add_argument("--to", dest="end", type=float, default=math.inf, metavar="T")
    parser.add_argument("--spots", type=_positive, metavar="R", help="draw live spots, of a 'dump local' in the folder, as circles of "
                        "radius R d")
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
    if options.keep and (len(options.runs) > 1 or not options.keep.endswith(".npz")):
        raise AnalysisError("--keep wants one run, and a file that ends in .npz")
    for name, pair in (("slice", options.slice), ("range", options.range)):
        if pair and not pair[0] < pair[1]:
            raise AnalysisError(f"--{name} {pair[0]:g} {pair[1]:g}: the first must be below the second")
    if not 100 <= options.height <= 4000:
        raise AnalysisError(f"--height {options.height} must be 100 to 4000 pixels")


def open_reel(word, options, progress):
    name, equals, path = word.rpartition("=")
    label = name if equals else os.path.basename(os.path.normpath(path))
    wanted = wanted_times(options)
    if path.endswith(".npz") and os.path.isfile(path):
        reel = load_pictures(label, path, wanted)
        if reel.colour != options.colour:
            raise AnalysisError(f"{path}: holds pictures coloured by {reel.colour}, not {options.colour}")
        return reel
    run = Run(label, path, options.diameter, command_line.print_warning)
    return take_pictures(run, options.colour, COLOURINGS[options.colour](run, options.layer), options.slice, wanted, progress)


def title(reel, picture):
    time = rf"$t = {picture.time:.4g}\,\tau$" if reel.tau else f"step {picture.time:g}"
    return f"{reel.label}, {time}" if reel.label else time


def write(options, reels, rows, progress):
    if options.spots and not any(len(picture.spots) for row in rows for picture in row):
        raise AnalysisError("--spots: no live spots in the runs' folders (the deck's line is 'dump ID all local N spots.dump f_ID[1] "
                            "f_ID[2] f_ID[3] f_ID[4] f_ID[5] f_ID[6]')")
    view = view_of(reels, rows, options.height, options.range, options.spots)
    panels = [[(title(reel, picture), picture, reel.container, reel.colour_label) for reel, picture in zip(reels, row)] for row in rows]
    if options.output.lower().endswith(".png"):
        draw(sum(panels, []), view, options.colour).save(options.output)
        return
    images = []
    for row in panels:
        images.append(draw(row, view, options.colour))
        progress(f"{len(images)} of {len(rows)} pictures drawn", len(images) / len(rows))
    if options.output.lower().endswith(files.ANIMATIONS):
        files.write_animation(options.output, images, options.fps, options.quality)
    else:
        files.write_frames(options.output, images)


def render():
    options = parse_arguments()
    check(options)
    progress = Progress("render", terminal_only=True)
    reels = [open_reel(word, options, progress) for word in options.runs]
    rows = at_common_times(reels)
    if options.keep:
        save_pictures(options.keep, reels[0])
    if options.output:
        write(options, reels, rows, progress)


def main():
    command_line.run(render)
