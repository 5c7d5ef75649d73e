# SPDX-License-Identifier: GPL-2.0-or-later
"""Draw runs side by side: one picture, PNG frames, an animation (GIF, WebP, MP4), or points for ParaView (VTK)."""

import os
from dataclasses import replace

import numpy as np

from ..base.errors import AnalysisError
from ..base.progress import Progress, share_of
from ..reading.dump import find_dumps
from ..rendering import files
from ..rendering.colouring import COLOURINGS
from ..rendering.drawing import draw, view_of
from ..rendering.kept_pictures import load_pictures, save_pictures
from ..rendering.pictures import at_common_times, take_pictures
from ..rendering.source import Run
from ..rendering.vtk import write_points
from ..statistics.snapshot import TIME_TOLERANCE
from . import command_line
from .render_options import check, parse_arguments, wanted_times


def split_word(word):
    """(label, path) of NAME=RUN or RUN."""
    name, equals, path = word.partition("=")
    if os.path.exists(word) or not equals:
        return os.path.basename(os.path.abspath(word)), word
    return name, path


def open_reel(word, options, progress):
    label, path = split_word(word)
    wanted = wanted_times(options)
    if path.endswith(".npz") and os.path.isfile(path):
        reel = load_pictures(label, path, wanted)
        if reel.colour != options.colour:
            raise AnalysisError(f"{path}: holds pictures coloured by {reel.colour}, not {options.colour}")
        return reel
    run = Run(label, path, options.diameter, command_line.print_warning)
    return take_pictures(run, options.colour, COLOURINGS[options.colour](run, options.layer), options.slice, wanted, progress)


def title(reel, picture):
    time = rf"$t = {round(picture.time, 1):g}\,\tau$" if reel.tau else f"step {picture.time:g}"
    return f"{reel.label}, {time}" if reel.label else time


def write(options, reels, rows, progress):
    if options.spots and not any(len(picture.spots) for row in rows for picture in row):
        raise AnalysisError("--spots: no live spots in the runs' folders (the deck's line is 'dump ID all local N spots.dump f_ID[1] "
                            "f_ID[2] f_ID[3] f_ID[4] f_ID[5] f_ID[6]')")
    view = view_of(reels, rows, options.height, options.range, options.spots)
    panels = [[(title(reel, picture), picture, reel.container, reel.colour_label) for reel, picture in zip(reels, row)] for row in rows]
    if options.output.lower().endswith(".png"):
        draw(sum(panels, []), view, options.colour).quantize(256).save(options.output, optimize=True)  # flat colours: a third of the size
        return
    images = []
    for row in panels:
        images.append(draw(row, view, options.colour))
        progress(f"{len(images)} of {len(rows)} pictures drawn", len(images) / len(rows))
    if options.output.lower().endswith(files.ANIMATIONS):
        files.write_animation(options.output, images, options.fps, options.quality)
    else:
        files.write_frames(options.output, images)


def check_times(asked, found):
    """Raise AnalysisError where a time that was asked for has no snapshot."""
    missing = [f"{time:g}" for time in asked or () if not any(abs(time - one) <= TIME_TOLERANCE for one in found)]
    if missing:
        raise AnalysisError(f"--times {' '.join(missing)}: no such snapshot, or not of all runs")


def write_vtk(options, progress):
    label, path = split_word(options.runs[0])
    run = Run(label, path, options.diameter, command_line.print_warning)
    colouring, wanted, found = COLOURINGS[options.colour](run, options.layer), wanted_times(options), []
    files = len(find_dumps(path))
    for seen, grains in enumerate(run.snapshots(), 1):
        colouring.see(grains)
        if wanted(grains.time):
            if len(found) % options.every == 0:
                number = len(found) // options.every
                values = colouring.values(grains, np.ones(len(grains.ids), dtype=bool))
                write_points(f"{options.output[:-len('.vtk')]}.{number:04}.vtk", grains, values, options.colour)
                progress(f"{number + 1} files written", share_of(seen, files))
            found.append(grains.time)
    if not found:
        raise AnalysisError(f"{path}: no snapshot at a time that was asked for")
    check_times(options.times, found)


def render():
    options = parse_arguments()
    check(options)
    if options.output and options.output.endswith(".vtk"):
        write_vtk(options, Progress("render"))
        return
    reels = [open_reel(word, options, Progress("render")) for word in options.runs]
    rows = at_common_times(reels)
    check_times(options.times, [row[0].time for row in rows])
    rows = rows[::options.every]
    if options.keep:
        save_pictures(options.keep, replace(reels[0], pictures=[row[0] for row in rows]))
    if options.output:
        write(options, reels, rows, Progress("render"))


def main():
    command_line.run(render)
