# SPDX-License-Identifier: GPL-2.0-or-later
"""Panels of grains side by side, as an image."""

from dataclasses import dataclass

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.collections import EllipseCollection
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure
from PIL import Image

from ..report.plots_silo import LATER_COLOUR, LAYER_COLOURS

DPI = 100
TITLE, BAR, MARGIN = 0.3, 0.6, 0.06  # inches
MAPS = {"speed": "viridis", "packing": "magma"}
SPOT_COLOUR = "#d1495b"


@dataclass(frozen=True)
class View:
    """What all panels share: x and z as (low, high) in d, height in pixels, colours from low to high, radius of spots in d."""

    x: tuple
    z: tuple
    height: int
    colours: tuple
    spot_radius: float = None


def view_of(reels, rows, height, colours, spot_radius):
    """The View that shows everything; colours : (low, high) or None, which takes the middle 98 % of all values."""
    pictures = [picture for row in rows for picture in row if len(picture.x)]
    known = [reel.container for reel in reels if reel.container]
    x = np.concatenate([picture.x for picture in pictures] + [[-one.half_width, one.half_width] for one in known] or [[0]])
    z = np.concatenate([picture.z for picture in pictures] + [[0, 1]])
    low = max(z.min(), -2) if known else z.min()
    if colours is None:
        values = np.concatenate([picture.values for picture in pictures] + [[]])
        values = values[np.isfinite(values)]
        colours = tuple(np.percentile(values, (1, 99))) if len(values) else (0, 1)
    return View((x.min() - 1, x.max() + 1), (low - 1, z.max() + 1), height, colours, spot_radius)


def draw(panels, view, colour):
    """A PIL.Image of ``panels``, [(title, picture, container, colour_label), ...] from left to right."""
    bar = BAR if colour in MAPS else MARGIN
    tall = view.height / DPI
    inner = tall - TITLE - bar
    wide = inner * (view.x[1] - view.x[0]) / (view.z[1] - view.z[0])
    width = len(panels) * (wide + MARGIN) + MARGIN
    figure = Figure(figsize=(width, tall), dpi=DPI)
    canvas = FigureCanvasAgg(figure)
    scale = Normalize(*view.colours)
    for index, (title, picture, container, _) in enumerate(panels):
        left = MARGIN + index * (wide + MARGIN)
        axis = figure.add_axes([left / width, bar / tall, wide / width, inner / tall])
        axis.set(xlim=view.x, ylim=view.z)
        axis.set_axis_off()
        axis.set_title(title, fontsize=9, pad=3)
        _draw_grains(axis, picture, colour, scale)
        _draw_spots(axis, picture.spots, view.spot_radius)
        if container:
            _draw_walls(axis, container, view.z[1])
    if colour in MAPS:
        place = figure.add_axes([0.15, 0.42 / tall, 0.7, 0.09 / tall])
        figure.colorbar(ScalarMappable(scale, MAPS[colour]), cax=place, orientation="horizontal").set_label(
            panels[0][3], fontsize=8, labelpad=1)
        place.tick_params(labelsize=7)
    canvas.draw()
    return Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")


def _draw_grains(axis, picture, colour, scale):
    known = np.isfinite(picture.values)
    if colour in MAPS:
        mapped = ScalarMappable(scale, MAPS[colour]).to_rgba(np.where(known, picture.values, 0))
    else:
        colours = ListedColormap(LAYER_COLOURS)
        mapped = colours(np.where(known, picture.values, 0).astype(int) % len(LAYER_COLOURS))
    mapped[~known] = ListedColormap([LATER_COLOUR])(0)
    axis.add_collection(EllipseCollection(
        picture.diameters, picture.diameters, np.zeros(len(picture.x)), units="x", transOffset=axis.transData,
        offsets=np.column_stack([picture.x, picture.z]), facecolors=mapped, edgecolors="white", linewidths=0.15))


def _draw_spots(axis, spots, radius):
    if radius is not None:
        size = np.full(len(spots), 2 * radius)
        axis.add_collection(EllipseCollection(size, size, 0 * size, units="x", offsets=spots, transOffset=axis.transData,
                                              facecolors=SPOT_COLOUR, linewidths=0, alpha=0.6))


def _draw_walls(axis, container, top):
    wall = {"color": "black", "linewidth": 1.2, "solid_capstyle": "butt"}
    for x, z in container.lines(top):
        axis.plot(x, z, **wall)
