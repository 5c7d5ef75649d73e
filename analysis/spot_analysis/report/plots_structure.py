# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures of the packing: its quality, g(r), g3(theta), order, local packing fraction, profiles across the thickness,
surface."""

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.ticker import FormatStrFormatter, LogLocator, NullFormatter

from ..statistics import bond_angles, bond_order, free_surface, radial_distribution, thickness, voronoi
from ..statistics.packing import fractions
from .plot_style import STYLE, TIME_LABEL, line_style, mark_interval, note_missing_data

START_STYLE = {"color": "0.6", "linewidth": 1.2}
LATE = plt.get_cmap("viridis")


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


def radial(views):
    """g(r) at the start and over the interval, once more beyond the contact peak."""
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.4), constrained_layout=True)
    for axis in axes:
        for name, view in views.items():
            r = radial_distribution.middles(view.run)
            if name == "DEM":
                axis.plot(r, radial_distribution.initial_rdf(view), label="DEM, at the start", **START_STYLE)
            axis.plot(r, radial_distribution.mean_rdf(view), label=name, **line_style(name), linewidth=1.2)
        axis.axhline(1, color="0.8", linewidth=0.8, zorder=0)
        axis.set(xlabel="$r$ ($d$)", ylabel="$g(r)$")
    note_missing_data(axes)
    axes[0].set(xlim=(0.8, 5), ylim=(0, None))
    axes[1].set(xlim=(1.05, 4), ylim=(0.5, 1.6))
    axes[0].legend(frameon=False)
    return figure


def angles(views):
    """g3 at the start and over the interval."""
    figure, axis = plt.subplots(figsize=(4.5, 3.4), constrained_layout=True)
    middle = (bond_angles.EDGES[1:] + bond_angles.EDGES[:-1]) / 2
    for name, view in views.items():
        if name == "DEM":
            axis.plot(middle, bond_angles.initial_density(view), label="DEM, at the start", **START_STYLE)
        axis.plot(middle, bond_angles.mean_density(view), label=name, **line_style(name), linewidth=1.2)
    note_missing_data([axis])
    axis.set(xlabel=r"bond angle $\theta$ (degrees)", ylabel=r"$g_3(\theta)$ (1/degree)", xlim=(30, 180), ylim=(0, None))
    axis.legend(frameon=False)
    return figure


def long_times(views):
    """g(r) at four times of each run, its ordering peaks, and the share of crystal-like grains."""
    figure, axes = plt.subplots(1, 3, figsize=(10, 3.3), constrained_layout=True)
    for axis, (name, view) in zip(axes, views.items()):
        run, columns = view.run, radial_distribution.columns(view.run)
        filled = np.flatnonzero(columns[:, -1])
        for share, part in zip(np.linspace(0, 0.85, 4), np.array_split(filled, 4)):
            if len(part):
                axis.plot(radial_distribution.middles(run), radial_distribution.rdf(run, columns[part].sum(axis=0)),
                          color=LATE(share), linewidth=1, label=f"{run.times[part[0]]:g}-{run.times[part[-1]]:g} $\\tau$")
        for place in radial_distribution.ORDER_PEAKS.values():
            axis.axvline(place, color="0.85", linewidth=0.8, zorder=0)
        axis.set(title=name, xlabel="$r$ ($d$)", ylabel="$g(r)$", xlim=(1.2, 3.2), ylim=(0.6, 1.8))
        note_missing_data([axis])
        axis.legend(frameon=False, fontsize=8)
    for name, view in views.items():
        part = view.run.measured[bond_order.NAME]
        axes[2].plot(part.times, 100 * part.share, label=name, **STYLE[name])
    axes[2].set(xlabel=TIME_LABEL, ylabel="crystal-like grains (%)", ylim=(0, None))
    note_missing_data([axes[2]])
    mark_interval([axes[2]], views)
    axes[2].legend(frameon=False)
    return figure


def local_packing(views):
    """Maps of the packing fraction of Voronoi cells over the interval, and their difference; None without data."""
    maps = {name: voronoi.mean_map(view) for name, view in views.items()}
    if any(one is None or not np.isfinite(one).any() for one in maps.values()):
        return None
    part = next(iter(views.values())).run.measured[voronoi.NAME]
    figure, axes = plt.subplots(1, 3, figsize=(10, 4.6), sharey=True, constrained_layout=True)
    for axis, (name, one) in zip(axes, maps.items()):
        mesh = axis.pcolormesh(part.x_edges, part.z_edges, one.T, vmin=0.5, vmax=0.64, cmap="viridis")
        axis.set_title(name, fontsize=10)
    figure.colorbar(mesh, ax=axes[:2], label="packing fraction", shrink=0.8, extend="both")
    mesh = axes[2].pcolormesh(part.x_edges, part.z_edges, (maps["spot"] - maps["DEM"]).T, vmin=-0.05, vmax=0.05,
                              cmap="RdBu_r")
    figure.colorbar(mesh, ax=axes[2], label="difference", shrink=0.8, extend="both")
    axes[2].set_title("spot less DEM", fontsize=10)
    for axis in axes:
        axis.set(xlabel="$x$ ($d$)", aspect="equal")
    axes[0].set_ylabel("$z$ ($d$)")
    return figure


def across_thickness(views):
    """Packing fraction and velocity from wall to wall across y; None where there are none."""
    if any(view.run.scene.periodic_y for view in views.values()):
        return None
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.2), constrained_layout=True)
    for name, view in views.items():
        left.plot(*thickness.fraction_profile(view), label=name, **line_style(name), linewidth=1.2)
        right.plot(*thickness.speed_profile(view), label=name, **STYLE[name])
    left.set(xlabel="$y$ ($d$)", ylabel="packing fraction", ylim=(0, None))
    right.set(xlabel="$y$ ($d$)", ylabel=r"$-v_z$ ($d/\tau$)", ylim=(0, None))
    note_missing_data([left, right])
    left.legend(frameon=False)
    return figure


def surface(views):
    """The free surface at the end of the interval and its angle against time."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.2), constrained_layout=True)
    for name, view in views.items():
        part = view.run.measured[free_surface.NAME]
        shared = np.isin(part.times, view.run.times[view.common])
        left.plot(part.x, part.heights[view.rows(part.times)[-1]], label=name, **{**STYLE[name], "markersize": 4})
        right.plot(part.times[shared], free_surface.angle(part.x, part.heights[shared]), label=name, **STYLE[name])
    left.set(xlabel="$|x|$ ($d$)", ylabel="highest grain ($d$)")
    right.set(xlabel=TIME_LABEL, ylabel="angle of the surface (degrees)")
    note_missing_data([left, right])
    mark_interval([right], views)
    left.legend(frameon=False)
    return figure
