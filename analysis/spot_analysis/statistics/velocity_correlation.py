# SPDX-License-Identifier: GPL-2.0-or-later
"""C(r): spatial correlation of the fluctuations of the x-velocity about the mean flow (2006).

Velocities are displacements between snapshots LAG_TAU apart, taken about the mean flow of ``mean_flow``:

    C(r) = <u(0) u(r)> / <u^2>,

over the pairs of grains r apart and over all grains. The sums that ``mean_flow`` speaks of stand for both.
"""

import numpy as np
from scipy.sparse import csr_matrix

from ..reading.container import nearest_image
from .fits import fit_exponential
from .mean_flow import COVER, SIZE, UPPER, Step, about_mean_flow, core, triangles
from .neighbours import close_pairs
from .snapshot import LAG_TAU
from .value import Value

NAME = "velocity_correlation"
BOTTOM, TOP = 50.0, 66.0  # d; as high as 2006's region is wide, where DEM flows steadily from 40 tau on
EDGES = np.linspace(1, 6, 21)  # d; grains do not come closer, spots do not reach further
MEANING = {
    "correlation_length": "beta of C(r) = alpha exp(-r/beta), 1-6 d",
    "correlation_amplitude": "alpha",
    "correlation_rms": "rms difference of C(r), 1-6 d",
}
NEEDS = {"*": ("pairs", "core")}


def pairs_by_distance(places, period=None):
    """first, second (p,): grains of the pairs whose distance lies in a bin of EDGES, and that bin (p,); places (n, 3); period : of
    y, None where nothing repeats."""
    first, second = close_pairs(places, EDGES[-1], period)
    distance = np.sqrt((nearest_image(places[first] - places[second], period)**2).sum(axis=1))
    place = np.searchsorted(EDGES, distance, side="right") - 1
    kept = (place >= 0) & (place < len(EDGES) - 1)
    return first[kept], second[kept], place[kept]


def frame_sums(middle, w, period=None):
    """Sums over the grains of a region: grains (), their moments (u,), pairs (k,), moments of pairs (k, u).

    middle : (n, 3); w : (n, SIZE) of ``mean_flow.Step``; k runs over the bins of EDGES, u over the triangle of w w^T
    """
    count, bins = len(middle), len(EDGES) - 1
    first, second, place = pairs_by_distance(middle, period)
    partners = csr_matrix((np.ones(len(first)), (place * count + first, second)), shape=(bins * count, count)) @ w
    joint = np.einsum("nk,bnl->bkl", w, partners.reshape(bins, count, SIZE))
    return count, triangles(w.T @ w), np.bincount(place, minlength=bins), triangles(joint)


class Measurement:
    """P pairs of snapshots whose region is full: start, end (P,), grains (P,), grain_moments (P, u), pairs (P, k),
    pair_moments (P, k, u)."""

    def __init__(self, container, region):
        self._region, self._period = core(container, BOTTOM, TOP), container.period
        self._rows = []

    def add(self, snapshot, history):
        start = history.earlier(LAG_TAU)
        if start is None or not self._region.is_covered(snapshot.positions, COVER):
            return
        step = Step(start, snapshot, self._region)
        if step.inside.sum() > 1:
            self._rows.append((step.start, step.end,
                               *frame_sums(step.middle[step.inside], step.w[step.inside], self._period)))

    def arrays(self):
        bins, size = len(EDGES) - 1, len(UPPER[0])
        columns = list(zip(*self._rows)) or [[], [], np.empty(0, dtype=np.int64), np.empty((0, size)),
                                             np.empty((0, bins), dtype=np.int64), np.empty((0, bins, size))]
        names = ("start", "end", "grains", "grain_moments", "pairs", "pair_moments")
        return {name: np.array(column) for name, column in zip(names, columns)}


def columns(part):
    """(P, f): the four arrays side by side, to be summed over time."""
    return np.hstack([part.grains[:, None], part.grain_moments, part.pairs,
                      part.pair_moments.reshape(len(part.grains), (len(EDGES) - 1) * len(UPPER[0]))])


def correlation(sums):
    """C (..., k) from summed ``columns`` (..., f); not a number at distances without pairs."""
    bins, size = len(EDGES) - 1, len(UPPER[0])
    grains, own, pairs, joint = np.split(sums, np.cumsum([1, size, bins]), axis=-1)
    joint = joint.reshape(*joint.shape[:-1], bins, size)
    products = about_mean_flow(own, np.concatenate([own[..., None, :], joint], axis=-2))
    with np.errstate(invalid="ignore", divide="ignore"):
        return products[..., 1:] / pairs / (products[..., :1] / grains)


def middles():
    return (EDGES[1:] + EDGES[:-1]) / 2


def fit(curve):
    """alpha, beta of alpha exp(-r/beta) over all bins alike; curve (..., k)."""
    return fit_exponential(middles(), curve)


def mean_correlation(view):
    """C(r) over the interval, (k,); None without data."""
    part = view.run.measured[NAME]
    rows = view.pair_rows(part.start, part.end)
    return correlation(columns(part)[rows].sum(axis=0)) if len(rows) else None


def quantities(view):
    part = view.run.measured[NAME]

    def estimate(unit, statistic):
        return view.estimate_pairs(unit, part.start, part.end, columns(part), statistic)

    return {"correlation_length": estimate("d", lambda sums: fit(correlation(sums))[1]),
            "correlation_amplitude": estimate("1", lambda sums: fit(correlation(sums))[0])}


def rms_difference(one, other):
    """Value of the root mean square of the difference of two curves (k,); unknown where one of them is None."""
    if one is None or other is None:
        return Value("1")
    return Value.of("1", np.sqrt(((one - other)**2).mean()))


def between(dem, spot):
    """Root mean square of the difference of C(r)."""
    return {"correlation_rms": rms_difference(mean_correlation(dem), mean_correlation(spot))}
