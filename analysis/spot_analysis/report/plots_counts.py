# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures of counts and fluxes against time. Each is a function from two IntervalViews to a matplotlib figure, as in the
other files of pictures."""

import numpy as np
from matplotlib import pyplot as plt

from ..statistics.counts import FLUX_HEIGHTS, SLAB, slab_counts
from .plot_style import STYLE, TIME_LABEL, mark_interval


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
