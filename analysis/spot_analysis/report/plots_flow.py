# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures of velocities: profiles, correlation, diffusion; and of what follows from them: stagnant zone, residence."""

import numpy as np
from matplotlib import pyplot as plt

from ..statistics import mixing, particle_diffusion, profile_width, residence, stagnation, velocity_correlation
from ..statistics.fits import fit_line
from .papers import PAPERS
from .plot_style import PAPER_STYLE, STYLE, TIME_LABEL, line_style, mark_interval, note_missing_data

PROFILES = (10, 20, 30, 40, 50, 60)  # d


def velocity_profiles(views):
    """Downward velocity across x with its Gaussian fits."""
    figure, axes = plt.subplots(2, 3, figsize=(9, 5.2), sharex=True, constrained_layout=True)
    for axis, height in zip(axes.flat, PROFILES):
        for name, view in views.items():
            edges = view.run.profile_edges
            index = int(np.searchsorted(view.run.profile_heights, height))
            x = np.linspace(edges[0], edges[-1], 201)
            style = {**STYLE[name], "linestyle": "none"}
            axis.plot((edges[1:] + edges[:-1]) / 2, profile_width.mean_profile(view, index), label=name, **style)
            axis.plot(x, profile_width.fitted_gaussian(view, index, x), **line_style(name), linewidth=1)
        axis.set_title(f"$z = {height:g}\\,d$", fontsize=10)
        axis.set_ylim(0, None)
    note_missing_data(axes.flat)
    for axis in axes[:, 0]:
        axis.set_ylabel(r"$-v_z$ ($d/\tau$)")
    for axis in axes[1]:
        axis.set_xlabel("$x$ ($d$)")
    axes[0, 0].legend(frameon=False)
    return figure


def profile_variance(views):
    """Variance of the Gaussian fits against height and the straight lines through them."""
    figure, axis = plt.subplots(figsize=(4.5, 3.4), constrained_layout=True)
    z = np.array([0.0, 75.0])
    for name, view in views.items():
        heights, variances = profile_width.mean_variances(view)
        slope, intercept = profile_width.line(heights, variances)
        axis.plot(heights, variances, label=name, **{**STYLE[name], "linestyle": "none", "markersize": 4})
        axis.plot(z, slope * z + intercept, **line_style(name), linewidth=1)
    axis.plot(z, PAPERS["variance_slope"][0] * z + PAPERS["variance_intercept"][0], label="DEM of 2006", **PAPER_STYLE)
    note_missing_data([axis])
    axis.axvspan(*profile_width.LINE, color="0.93", zorder=-1)
    axis.set(xlabel="$z$ ($d$)", ylabel="variance of the profile ($d^2$)", xlim=(0, 75), ylim=(0, None))
    axis.legend(frameon=False)
    return figure


def correlation(views):
    """C(r) with the fitted exponentials."""
    figure, axis = plt.subplots(figsize=(4.5, 3.4), constrained_layout=True)
    r = np.linspace(velocity_correlation.EDGES[0], velocity_correlation.EDGES[-1], 100)
    for name, view in views.items():
        curve = velocity_correlation.mean_correlation(view)
        if curve is None:
            continue
        alpha, beta = velocity_correlation.fit(curve)
        axis.plot(velocity_correlation.middles(), curve, label=f"{name}: $\\beta = {beta:.2f}\\,d$",
                  **{**STYLE[name], "linestyle": "none"})
        axis.plot(r, alpha * np.exp(-r / beta), **line_style(name), linewidth=1)
    note_missing_data([axis])
    axis.axhline(0, color="0.8", linewidth=0.8, zorder=0)
    axis.set(xlabel="$r$ ($d$)", ylabel="$C(r)$ of $v_x$", xlim=(0, velocity_correlation.EDGES[-1]))
    _legend(axis)
    return figure


def _legend(axis):
    """A legend, if there is anything to tell apart."""
    if axis.get_legend_handles_labels()[0]:
        axis.legend(frameon=False)


def diffusion(views):
    """Variance of x about the mean flow against the height dropped."""
    figure, axis = plt.subplots(figsize=(4.5, 3.4), constrained_layout=True)
    drops = particle_diffusion.DROPS
    line = np.array([0, drops[-1] + 0.3])
    for name, view in views.items():
        variances = particle_diffusion.mean_variances(view)
        if variances is None:
            continue
        slope, intercept = fit_line(drops, variances)
        axis.plot(drops, variances, label=f"{name}: $b_p = {1000 * slope / 2:.2f} \\times 10^{{-3}}\\,d$",
                  **{**STYLE[name], "linestyle": "none", "markersize": 4})
        axis.plot(line, intercept + slope * line, **line_style(name), linewidth=1)
    axis.plot(line, 2 * PAPERS["particle_diffusion"][0] * line, label="slope of DEM, 2006", **PAPER_STYLE)
    axis.set(xlabel="drop ($d$)", ylabel="variance of $x$ ($d^2$)", xlim=(0, line[-1]), ylim=(0, None))
    _legend(axis)
    return figure


def stagnant_zone(views):
    """Where the velocity falls below a share of that on the axis."""
    figure, axis = plt.subplots(figsize=(4.5, 3.4), constrained_layout=True)
    half_width = next(iter(views.values())).run.scene.container().half_width
    for name, view in views.items():
        heights, boundary = stagnation.boundaries(view)
        axis.plot(boundary, heights, label=name, **{**STYLE[name], "markersize": 4})
    if not any(np.isfinite(line.get_xdata()).any() for line in axis.lines):
        axis.text(0.5, 0.5, "no data", transform=axis.transAxes, ha="center", color="0.5")
    axis.set(xlabel="$|x|$ ($d$)", ylabel="$z$ ($d$)", xlim=(0, half_width), ylim=(0, 50))
    axis.legend(frameon=False)
    return figure


def residence_times(views):
    """Distribution of the time from a level to the orifice."""
    figure, axes = plt.subplots(1, len(residence.LEVELS), figsize=(9, 3.2), constrained_layout=True)
    middle = (residence.EDGES[1:] + residence.EDGES[:-1]) / 2
    for index, (axis, level) in enumerate(zip(axes, residence.LEVELS)):
        for name, view in views.items():
            axis.step(middle, residence.distribution(view, index), where="mid", label=name,
                      **line_style(name))
        axis.set_title(f"from $z = {level:g}\\,d$ to the orifice", fontsize=10)
        axis.set(xlabel=r"residence time ($\tau$)", ylabel=r"share (1/$\tau$)", ylim=(0, None))
    note_missing_data(axes)
    axes[0].legend(frameon=False)
    return figure


def layers(views):
    """Where drained grains came from, and how far layers have mixed."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.2), constrained_layout=True)
    highest = 1
    for name, view in views.items():
        height, lost = mixing.drained(view)
        highest = max(highest, height[lost > 0].max(initial=0))
        left.step(height, lost, where="mid", label=name, **line_style(name))
        part = view.run.measured[mixing.NAME]
        shared = np.isin(part.times, view.run.times[view.common])
        right.plot(part.times[shared], part.unlike[shared], label=name, **STYLE[name])
    left.set(xlabel="height at the start ($d$)", ylabel=f"grains drained, per {mixing.BAND:g} $d$", xlim=(0, 1.1 * highest))
    right.set(xlabel=TIME_LABEL, ylabel="neighbours of other layers")
    note_missing_data([left, right])
    mark_interval([right], views)
    left.legend(frameon=False)
    return figure
