# SPDX-License-Identifier: GPL-2.0-or-later
"""What the pictures have in common: colours, the shaded interval, the words where there is nothing to show."""

import matplotlib
import numpy as np

matplotlib.use("Agg")  # pictures go to files; there may be no display

STYLE = {"DEM": {"color": "#1b4965", "marker": "o", "markersize": 3},
         "spot": {"color": "#d1495b", "marker": "s", "markersize": 3, "linestyle": "--"}}
PAPER_STYLE = {"color": "0.5", "linewidth": 1, "linestyle": ":"}
TIME_LABEL = r"time ($\tau$)"


def line_style(name):
    """The style of a run without markers, for fits and curves of many points."""
    return {"color": STYLE[name]["color"], "linestyle": STYLE[name].get("linestyle", "-")}


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
