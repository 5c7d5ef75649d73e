# SPDX-License-Identifier: GPL-2.0-or-later
"""C(r) of the x-velocity about each frame's own linear flow: what grains do against their neighbours.

Velocities are displacements between snapshots LAG_TAU apart, in the core of ``mean_flow``. From those of each frame its own
a + b x + c z is subtracted, fitted by least squares, and with it the sway, strain and rotation of the whole region, which
C(r) about the flow's mean in time (``velocity_correlation``) holds as well:

    C(r) = <u(0) u(r)> / <u^2>,

over the pairs of grains r apart and over all grains.
"""

import numpy as np

from .flow import common_grains
from .mean_flow import COVER, core
from .snapshot import LAG_TAU
from .velocity_correlation import BOTTOM, EDGES, TOP, pairs_by_distance, rms_difference

NAME = "frame_correlation"
MEANING = {
    "frame_velocity_rms": "v_x about each frame's linear flow",
    "frame_correlation_rms": "rms difference of C(r) about it, 1-6 d",
}
NEEDS = {"*": ("stored", "pairs", "core")}


def residuals(places, values):
    """``values`` (n,) less the a + b x + c z that fits them best; places (n, 3)."""
    terms = np.column_stack([np.ones(len(places)), places[:, 0], places[:, 2]])
    return values - terms @ np.linalg.lstsq(terms, values, rcond=None)[0]


def pair_sums(places, values, period=None):
    """Pairs (k,) in each bin of EDGES and the sum of the products of their two ``values`` (k,); places (n, 3), values (n,)."""
    bins = len(EDGES) - 1
    first, second, place = pairs_by_distance(places, period)
    return np.bincount(place, minlength=bins), np.bincount(place, values[first] * values[second], minlength=bins)


class Measurement:
    """P pairs of snapshots whose region is full: start, end (P,), grains (P,), squares (P,): sum of u^2, pairs (P, k), products
    (P, k): sum of u u' over them; u in d/tau."""

    def __init__(self, container, region):
        self._region, self._period = core(container, BOTTOM, TOP), container.period
        self._rows = []

    def add(self, snapshot, history):
        start = history.earlier(LAG_TAU)
        if start is None or not self._region.is_covered(snapshot.positions, COVER):
            return
        first, second = common_grains(start.ids, snapshot.ids)
        moved = snapshot.positions[second] - start.positions[first]
        middle = start.positions[first] + moved / 2
        inside = self._region.contains(middle)
        if inside.sum() > 3:  # three grains lie on one plane
            middle, duration = middle[inside], snapshot.time - start.time
            u = residuals(middle, moved[inside, 0] / duration)
            self._rows.append((start.time, snapshot.time, len(u), u @ u, *pair_sums(middle, u, self._period)))

    def arrays(self):
        bins = len(EDGES) - 1
        columns = list(zip(*self._rows)) or [[], [], np.empty(0, dtype=np.int64), [], np.empty((0, bins), dtype=np.int64),
                                             np.empty((0, bins))]
        return dict(zip(("start", "end", "grains", "squares", "pairs", "products"), map(np.array, columns)))


def correlation(part, rows):
    """C (k,) over the pairs of snapshots ``rows``; not a number where there is no motion or no pair."""
    with np.errstate(invalid="ignore", divide="ignore"):
        return (part.products[rows].sum(axis=0) / part.pairs[rows].sum(axis=0)
                / (part.squares[rows].sum() / part.grains[rows].sum()))


def mean_correlation(view):
    """C(r) over the interval, (k,), in the bins of EDGES; None without data."""
    part = view.run.measured[NAME]
    rows = view.pair_rows(part.start, part.end)
    return correlation(part, rows) if len(rows) else None


def quantities(view):
    part = view.run.measured[NAME]
    columns = np.column_stack([part.squares, part.grains])
    return {"frame_velocity_rms": view.estimate_pairs("d/tau", part.start, part.end, columns, _root_of_mean)}


def _root_of_mean(sums):
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.sqrt(sums[..., 0] / sums[..., 1])


def between(dem, spot):
    """Root mean square of the difference of C(r)."""
    return {"frame_correlation_rms": rms_difference(mean_correlation(dem), mean_correlation(spot))}
