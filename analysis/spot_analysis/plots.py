# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures of a comparison, each a function from two IntervalViews to a matplotlib figure."""

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402  (the backend comes first)
import numpy as np  # noqa: E402
from matplotlib.collections import EllipseCollection  # noqa: E402
from matplotlib.ticker import FormatStrFormatter, LogLocator, NullFormatter  # noqa: E402

from .comparison import FLUX_HEIGHTS, SLAB, rdf_edges  # noqa: E402
from .run_statistics import LAYER_HEIGHT  # noqa: E402
from .structure import packing_fraction  # noqa: E402

STYLE = {"DEM": {"color": "#1b4965", "marker": "o", "markersize": 3},
         "spot": {"color": "#d1495b", "marker": "s", "markersize": 3, "linestyle": "--"}}
LAYER_COLOURS = ["#1b4965", "#f4a259", "#5fa8d3", "#bc4b51", "#8cb369", "#5b3758"]
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
    _mark_interval([left, right], views)
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
    _mark_interval(axes.flat, views)
    for axis in axes[1]:
        axis.set_xlabel(TIME_LABEL)
    for axis in axes[:, 0]:
        axis.set_ylabel(r"flux (1/$\tau$)")
    axes[0, 0].legend(frameon=False)
    return figure


def slab_counts(views):
    """Grains in the slab of 2006, against time."""
    figure, axis = plt.subplots(figsize=(5.5, 3.4), constrained_layout=True)
    for name, view in views.items():
        count = (view.run.count_above(SLAB[0]) - view.run.count_above(SLAB[1]))[view.common]
        axis.plot(view.run.times[view.common], count, label=name, **STYLE[name])
    axis.set(xlabel=TIME_LABEL, ylabel=f"grains in ${SLAB[0]}\\,d < z < {SLAB[1]}\\,d$")
    _mark_interval([axis], views)
    axis.legend(frameon=False)
    return figure


def velocity_profiles(views):
    """Downward velocity across x at the stored heights, mean over the interval."""
    heights = next(iter(views.values())).run.profile_heights
    figure, axes = plt.subplots(1, len(heights), figsize=(3.2 * len(heights), 3.2), constrained_layout=True)
    for index, (axis, height) in enumerate(zip(axes, heights)):
        for name, view in views.items():
            profile = view.profile(index)
            if profile is not None:
                edges = view.run.profile_edges
                axis.plot((edges[1:] + edges[:-1]) / 2, profile, label=name, **STYLE[name])
        axis.set_title(f"$z = {height:g}\\,d$", fontsize=10)
        axis.set_xlabel("$x$ ($d$)")
    _note_missing_data(axes)
    axes[0].set_ylabel(r"$-v_z$ ($d/\tau$)")
    axes[0].legend(frameon=False)
    return figure


def radial_distribution(views):
    """g(r) at the start and over the interval."""
    figure, axis = plt.subplots(figsize=(6.5, 3.8), constrained_layout=True)
    for name, view in views.items():
        edges = rdf_edges(view.run)
        middle = (edges[1:] + edges[:-1]) / 2
        if name == "DEM":
            axis.plot(middle, view.rdf(view.initial_rdf_sums()), color="0.6", label="DEM, at the start")
        axis.plot(middle, view.rdf(view.rdf_sums().sum(axis=0)), label=name, **STYLE[name])
    _note_missing_data([axis])
    axis.axhline(1, color="0.8", linewidth=0.8, zorder=0)
    axis.set(xlabel="$r$ ($d$)", ylabel="$g(r)$", xlim=(0.8, 5), ylim=(0, None))
    axis.legend(frameon=False)
    return figure


def packing_quality(views):
    """Packing fraction, contacts and badness in the region, against time."""
    figure, axes = plt.subplots(1, 3, figsize=(10, 3.2), constrained_layout=True)
    for name, view in views.items():
        run, common = view.run, view.common
        covered = np.where(np.isfinite(run.badness), 1, np.nan)
        fraction = covered * packing_fraction(run.region_grains, run.region(), run.scene.container())
        for axis, samples in zip(axes, (fraction, run.contacts, run.badness)):
            axis.plot(run.times[common], samples[common], label=name, **STYLE[name])
    for axis, label in zip(axes, ("packing fraction", "contacts a grain", "badness $B$")):
        axis.set(xlabel=TIME_LABEL, ylabel=label)
    _note_missing_data(axes)
    axes[2].set_yscale("log")
    axes[2].yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axes[2].yaxis.set_major_formatter(FormatStrFormatter("%.0e"))
    axes[2].yaxis.set_minor_formatter(NullFormatter())
    _mark_interval(axes, views)
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
    axis.add_collection(EllipseCollection(
        diameter, diameter, 0 * diameter, units="x", offsets=np.column_stack([x, z]), transOffset=axis.transData,
        facecolors=colours[layer % len(colours)], edgecolors="white", linewidths=0.15))
    wall = {"color": "black", "linewidth": 1.2}
    for side in (-1, 1):
        axis.plot([side * container.half_width] * 2, [0, run.levels[-1] + 2], **wall)
        axis.plot([side * container.orifice_radius, side * container.half_width], [0, 0], **wall)


def _note_missing_data(axes):
    """Say so where neither run has anything to show, as in a silo that is too low."""
    for axis in axes:
        if not any(np.isfinite(line.get_ydata()).any() for line in axis.lines):
            axis.text(0.5, 0.5, "no data", transform=axis.transAxes, ha="center", color="0.5")


def _mark_interval(axes, views):
    """Shade the interval that the table's rates are taken over."""
    interval = next(iter(views.values())).interval
    for axis in axes:
        axis.axvspan(*interval.span, color="0.93", zorder=-1)


FIGURES = {
    "silos": (silos, "The layer of grains at the front wall, coloured by the height it started at "
                     f"(bands of {LAYER_HEIGHT:g} d)."),
    "drained_grains": (drained_grains, "Grains left above z = 0, and the outflow. Shaded: the interval compared."),
    "fluxes": (fluxes, "Flux through four heights. In steady flow each equals the outflow."),
    "slab_counts": (slab_counts, "Grains in the slab in which 2006 measures the density drop."),
    "velocity_profiles": (velocity_profiles,
                          "Downward velocity, from displacements over 2 tau, mean over the interval."),
    "radial_distribution": (radial_distribution, "g(r) in the structure region, corrected for the slab."),
    "packing_quality": (packing_quality, "Packing fraction, contacts a grain and badness in the same region."),
}
