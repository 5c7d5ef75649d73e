# SPDX-License-Identifier: GPL-2.0-or-later
"""Fluctuations of the outflow: its Fano factor."""

import numpy as np

from .snapshot import LAG_TAU, TIME_TOLERANCE

MEANING = {"outflow_fano": "variance over mean of counts in 2 tau; Poisson 1"}
NEEDS = {"*": ("outflow", "pairs")}


def fano_factor(sums):
    """Variance over mean of counts, (...), from sums (..., 3) of counts, squares and ones: 1 for a Poisson process."""
    total, squares, number = np.moveaxis(sums, -1, 0)
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = total / number
        return (squares / number - mean**2) * number / (number - 1) / mean


def counts(view, level):
    """Ends of the intervals LAG_TAU long (n,) tau, and grains that crossed ``level`` in each (n,)."""
    times = view.run.times[view.snapshots]
    crossed = -np.diff(view.run.count_above(level)[view.snapshots])
    even = np.abs(np.diff(times) - LAG_TAU) <= TIME_TOLERANCE
    return times[1:][even], crossed[even].astype(float)


def quantities(view):
    times, crossed = counts(view, 0)
    columns = np.column_stack([crossed, crossed**2, np.ones(len(crossed))])
    return {"outflow_fano": view.estimate("1", times, columns, fano_factor, minimum=3)}
