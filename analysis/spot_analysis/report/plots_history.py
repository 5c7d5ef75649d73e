# SPDX-License-Identifier: GPL-2.0-or-later
"""The picture of what a lasting flow must keep, to the end of the run."""

from matplotlib import pyplot as plt

from ..statistics import through_time
from .plot_style import STYLE, TIME_LABEL, mark_interval, note_missing_data

PANELS = {"packing_fraction": ("packing fraction", 1), "crystal_share": ("crystal-like grains (%)", 100),
          "rdf_at_sqrt3": (r"$g(\sqrt{3}\,d)$", 1), "surface_angle": ("angle of the surface (degrees)", 1)}


def through_the_run(views):
    """Packing fraction, order, g at sqrt(3) d and the surface's angle at all common times."""
    figure, axes = plt.subplots(2, 2, figsize=(9, 5.4), sharex=True, constrained_layout=True)
    for name, view in views.items():
        found = through_time.series(view)
        for axis, (quantity, (label, factor)) in zip(axes.flat, PANELS.items()):
            times, samples = found[quantity]
            axis.plot(times, factor * samples, label=name, linewidth=1, **STYLE[name])
            axis.set_ylabel(label)
    axes[0, 1].set_ylim(0, None)
    for axis in axes[1]:
        axis.set_xlabel(TIME_LABEL)
    note_missing_data(axes.flat)
    mark_interval(axes.flat, views)
    axes[0, 0].legend(frameon=False)
    return figure
