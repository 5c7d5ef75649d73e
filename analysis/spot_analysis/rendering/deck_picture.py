# SPDX-License-Identifier: GPL-2.0-or-later
"""The picture of a dry run: two upright slices through an outlet, with walls, grains, live spots and ways of some."""

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import EllipseCollection
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from .drawing import SPOT_COLOUR

WALL, GRAIN, OUTLET, WAY = "#8d99a6", "#f1d9b0", "#2a9d4a", "#1d3557"
HEIGHT, DPI = 8.0, 110  # inches, pixels an inch
NARROWEST, WIDEST = 7.0, 14.0  # inches
NEAR = 1.0  # d from the slice: live spots that are drawn


def draw(run, path):
    """Write the picture of a dry run, as of its JSON, to the file ``path``."""
    d = run["diameter"]
    slices = [_Slice(one, run) for one in run["slices"]]
    ratios = [one.width / one.height for one in slices]
    wide = min(max(HEIGHT * sum(ratios) + 2.0, NARROWEST), WIDEST)
    figure = Figure(figsize=(wide, HEIGHT + 0.6), dpi=DPI, layout="constrained")
    for axis, one in zip(figure.subplots(1, len(slices), width_ratios=ratios, squeeze=False)[0], slices):
        one.draw(axis, d)
    figure.suptitle("grains cut by the slice: sand    live spots near it: red    ways of the first spots: blue    outlets: green", fontsize=8)
    FigureCanvasAgg(figure).print_png(path)


class _Slice:
    """An upright slice, in d, cut to what there is to see.

    data : of the JSON; run : all of it
    """

    def __init__(self, data, run):
        d = run["diameter"]
        self.along, self.across = (0, 1) if data["across"] == "y" else (1, 0)
        self.at = data["at"] / d
        self.inside = np.array([[cell == "1" for cell in row] for row in data["inside"]])
        self.low, self.high = np.array(data["low"]) / d, np.array(data["high"]) / d
        self.grains = np.array(data["grains"]).reshape(-1, 2) / d
        self.live = np.array(run["live"]).reshape(-1, 3) / d
        self.ways = [np.array(way).reshape(-1, 3) / d for way in run["ways"]]
        self.outlets = run["outlets"]
        top = max([self.grains[:, 1].max(initial=self.low[1]), *(way[:, 2].max() for way in self.ways if len(way))]) + 2
        bottom = min(outlet["centre"][2] for outlet in self.outlets) / d - run["radius"] / d - 2
        self.z = (max(bottom, self.low[1]), min(top, self.high[1]))

    @property
    def width(self):
        return self.high[0] - self.low[0]

    @property
    def height(self):
        return self.z[1] - self.z[0]

    def draw(self, axis, d):
        x, z = (self.low[k] + (np.arange(cells) + 0.5) * (self.high[k] - self.low[k]) / cells for k, cells in enumerate(self.inside.shape[::-1]))
        axis.set_aspect("equal")
        axis.set_facecolor(WALL)
        axis.contourf(x, z, self.inside, levels=[0.5, 1.5], colors=["white"])
        axis.xaxis.set_major_locator(MaxNLocator(max(2, int(self.width / self.height * 10)), integer=True))
        size = np.ones(len(self.grains))
        axis.add_collection(EllipseCollection(size, size, 0 * size, units="x", offsets=self.grains, transOffset=axis.transData,
                                              facecolors=GRAIN, edgecolors="#b08d57", linewidths=0.3))
        near = self.live[abs(self.live[:, self.across] - self.at) < NEAR]
        axis.plot(near[:, self.along], near[:, 2], ".", color=SPOT_COLOUR, markersize=1.5, alpha=0.6)
        for way in self.ways:
            x = way[:, self.along]
            jumps = np.flatnonzero(abs(np.diff(x)) > self.width / 2) + 1  # to the other side of a silo that repeats
            axis.plot(np.insert(x, jumps, np.nan), np.insert(way[:, 2], jumps, np.nan), color=WAY, linewidth=0.8, alpha=0.7)
        for outlet in self.outlets:
            centre, half = np.array(outlet["centre"]) / d, outlet["half_widths"][self.along] / d
            axis.plot(centre[self.along] + np.array([-half, half]), [centre[2]] * 2, color=OUTLET, linewidth=3, solid_capstyle="butt")
        axis.set(xlim=(self.low[0], self.high[0]), ylim=self.z, xlabel=f"{'xy'[self.along]} (d)", ylabel="z (d)",
                 title=f"{'xy'[self.across]} = {round(self.at, 1) + 0.0:g} d")
