# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures of what a comparison shows against time, and of the silos. Each is a function from two IntervalViews to a
matplotlib figure; what they share with the other files of pictures is here, too."""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402  (the backend comes first)
import numpy as np  # noqa: E402
from matplotlib.collections import EllipseCollection  # noqa: E402
from matplotlib.ticker import FormatStrFormatter, LogLocator, NullFormatter  # noqa: E402

from ..statistics.counts import FLUX_HEIGHTS, SLAB, slab_counts  # noqa: E402
from ..statistics.packing import fractions  # noqa: E402

STYLE = {"DEM": {"color": "#1b4965", "marker": "o", "markersize": 3},
         "spot": {"color": "#d1495b", "marker": "s", "markersize": 3, "linestyle": "--"}}
LAYER_COLOURS = ["#1b4965", "#f4a259", "#5fa8d3", "#bc4b51", "#8cb369", "#5b3758"]
LATER_COLOUR = "0.7"  # of grains that were not there at the start
PAPER_STYLE = {"color": "0.5", "linewidth": 1, "linestyle": ":"}
TIME_LABEL = r"time ($\tau$)"


def drained_grains(views):
    """Grains above z = 0 and what flowed out, against time."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.4), constrained_layout=True)
    for name, view in views.items():
        times, above = view.run.times[view.common], view.run.count_above(0)[view.common]
        left.plot(times, above, label=name, **STYLE[name])
        right.plot((times[1:] + times[:-1]) / 2, -np.diff(above) / np.diff(times), label=name, **STYLE[name])
    left.set(xlabel=TIME_LABEL, ylabel="grains above $z = 0$")
    right.set(xlabel=TIME_LABEL, ylabel=r"outflow (1/$\tau$)")
    right.set_ylim(0, 1.15 * right.get_ylim()[1])
    mark_interval([left, right], views)
    left.legend(frameon=False)
    return figure


def fluxes(views):
    """Flux through the heights of the table, against time."""
    figure, axes = plt.subplots(2, 2, figsize=(9, 5.4), sharex=True, sharey=True, constrained_layout=True)
    for axis, height in zip(axes.flat, FLUX_HEIGHTS):
        for name, view in views.items():
            times = view.run.times[view.common]
            crossed = -np.diff(view.run.count_above(height)[view.common])
            axis.plot((times[1:] + times[:-1]) / 2, crossed / np.diff(times), label=name, **STYLE[name])
        axis.set_title(f"$z = {height}\\,d$", fontsize=10)
    mark_interval(axes.flat, views)
    for axis in axes[1]:
        axis.set_xlabel(TIME_LABEL)
    for axis in axes[:, 0]:
        axis.set_ylabel(r"flux (1/$\tau$)")
    axes[0, 0].legend(frameon=False)
    return figure


def density_drop(views):
    """Grains in the slab of 2006, against time."""
    figure, axis = plt.subplots(figsize=(5.5, 3.4), constrained_layout=True)
    for name, view in views.items():
        axis.plot(view.run.times[view.common], slab_counts(view.run)[view.common], label=name, **STYLE[name])
    axis.set(xlabel=TIME_LABEL, ylabel=f"grains in ${SLAB[0]}\\,d < z < {SLAB[1]}\\,d$")
    mark_interval([axis], views)
    axis.legend(frameon=False)
    return figure


def packing_quality(views):
    """Packing fraction, contacts and badness in the region, against time."""
    figure, axes = plt.subplots(1, 3, figsize=(10, 3.2), constrained_layout=True)
    for name, view in views.items():
        run, common = view.run, view.common
        for axis, samples in zip(axes, (fractions(run), run.contacts, run.badness)):
            axis.plot(run.times[common], samples[common], label=name, **STYLE[name])
    for axis, label in zip(axes, ("packing fraction", "contacts a grain", "badness $B$")):
        axis.set(xlabel=TIME_LABEL, ylabel=label)
    note_missing_data(axes)
    axes[2].set_yscale("log")
    axes[2].yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axes[2].yaxis.set_major_formatter(FormatStrFormatter("%.0e"))
    axes[2].yaxis.set_minor_formatter(NullFormatter())
    mark_interval(axes, views)
    axes[0].legend(frameon=False)
    return figure


def silos(views):
    """The front layers of both silos at the last time that both have a picture of; None if there is none."""
    dem, spot = (view.run for view in views.values())
    shared = [(i, j) for i, t in enumerate(dem.picture_times) for j, s in enumerate(spot.picture_times)
              if abs(t - s) < 0.05]
    if not shared:
        return None
    top = max(dem.levels[-1], spot.levels[-1]) + 2
    container = dem.scene.container()
    width = 2 * container.half_width + 4
    figure, axes = plt.subplots(1, 2, figsize=(8, 0.6 + 3.6 * top / width), sharey=True, constrained_layout=True)
    for axis, (name, view), index in zip(axes, views.items(), shared[-1]):
        _draw_silo(axis, view.run, index)
        axis.set_title(f"{name}, $t = {view.run.picture_times[index]:g}\\,\\tau$", fontsize=10)
        axis.set(xlim=(-width / 2, width / 2), ylim=(-2, top), xlabel="$x$ ($d$)", aspect="equal")
    axes[0].set_ylabel("$z$ ($d$)")
    return figure


def _draw_silo(axis, run, index):
    x, z, layer = run.picture(index)
    container = run.scene.container()
    colours = np.array([matplotlib.colors.to_rgba(colour) for colour in LAYER_COLOURS])
    diameter = np.ones(len(x))
    fill = np.where((layer < 0)[:, None], matplotlib.colors.to_rgba(LATER_COLOUR), colours[layer % len(colours)])
    axis.add_collection(EllipseCollection(
        diameter, diameter, 0 * diameter, units="x", offsets=np.column_stack([x, z]), transOffset=axis.transData,
        facecolors=fill, edgecolors="white", linewidths=0.15))
    wall = {"color": "black", "linewidth": 1.2}
    for side in (-1, 1):
        axis.plot([side * container.half_width] * 2, [0, run.levels[-1] + 2], **wall)
        axis.plot([side * container.orifice_radius, side * container.half_width], [0, 0], **wall)


def note_missing_data(axes):
    """Say so where neither run has anything to show, as in a silo that is too low."""
    for axis in axes:
        if not any(np.isfinite(line.get_ydata()).any() for line in axis.lines):
            axis.text(0.5, 0.5, "no data", transform=axis.transAxes, ha="center", color="0.5")


def mark_interval(axes, views):
    """Shade the interval that the table's rates are taken over."""
    interval = next(iter(views.values())).interval
    for axis in axes:
        axis.axvspan(*interval.span, color="0.93", zorder=-1)
