# SPDX-License-Identifier: GPL-2.0-or-later
"""C(r): spatial correlation of the fluctuations of the x-velocity about the mean flow (2006).

Velocities are displacements between snapshots LAG_TAU apart. The mean flow is a field of (x, z), constant in time but
for its amplitude: v_x(x, z, t) = a(t) sum_k c_k f_k(x, z), where a(t) is the mean downward speed in the region and f_k
are the polynomials of ``mean_flow_terms``; c_k are fitted by least squares to all grains of the interval.

What is stored are sums over grains and pairs of products of w = (v_x, a f_1, ..., a f_m). From them C(r) follows for any
choice of times, with its own mean flow subtracted: the fluctuation of a grain is q.w with q = (1, -c), so

    C(r) = q.M(r).q / n(r) / (q.M_0.q / n_0),

M(r) the sum of w_i w_j over the n(r) pairs at distance r, M_0 that of w_i w_i over the n_0 grains.
"""

import numpy as np
from scipy.sparse import csr_matrix
from scipy.spatial import cKDTree

from .container import Region
from .fits import fit_exponential
from .flow import common_grains
from .interval import Value
from .snapshot import LAG_TAU

NAME = "velocity_correlation"
HALF_WIDTH = 8.0  # d; the region is as wide as it is high, high up in the centre, where DEM flows steadily from 40 tau on
BOTTOM, TOP = 50.0, 66.0
EDGES = np.linspace(0, 8, 33)  # d
FITTED = (1.0, 6.0)  # d; grains do not come closer than 1 d
TERMS = 6
SIZE = TERMS + 1
UPPER = np.triu_indices(SIZE)


def correlation_region(container):
    return Region(min(HALF_WIDTH, 0.8 * container.half_width), BOTTOM, TOP)


def mean_flow_terms(x, z, region):
    """f_k of the mean flow at (n,) places; (n, TERMS), each about 1 at the border of the region."""
    u, v = x / region.half_width, 2 * (z - region.bottom) / (region.top - region.bottom) - 1
    return np.stack([np.ones_like(u), v, u, u * v, u**3, u**3 * v], axis=1)


def frame_sums(start, end, duration, region):
    """Sums over one pair of snapshots; start, end (n, 3): positions of the same grains.

    A grain belongs to the region that holds the middle of its displacement. Returns grains n_0 (), moments of grains
    (u,), pairs n(r) (k,), moments of pairs (k, u), where u runs over the upper triangle of M.
    """
    middle = (start + end) / 2
    inside = region.contains(middle)
    middle, velocity = middle[inside], (end - start)[inside] / duration
    count, bins = len(middle), len(EDGES) - 1
    if count < 2:
        return count, np.zeros(len(UPPER[0])), np.zeros(bins, dtype=np.int64), np.zeros((bins, len(UPPER[0])))
    amplitude = -velocity[:, 2].mean()
    w = np.column_stack([velocity[:, 0], amplitude * mean_flow_terms(middle[:, 0], middle[:, 2], region)])
    first, second = cKDTree(middle).query_pairs(EDGES[-1], output_type="ndarray").T
    distance = np.sqrt(((middle[first] - middle[second])**2).sum(axis=1))
    place = np.minimum((distance / EDGES[1]).astype(np.int64), bins - 1)
    partners = csr_matrix((np.ones(len(first)), (place * count + first, second)), shape=(bins * count, count)) @ w
    moments = np.einsum("nk,bnl->bkl", w, partners.reshape(bins, count, SIZE))
    moments = (moments + moments.transpose(0, 2, 1)) / 2
    return count, (w.T @ w)[UPPER], np.bincount(place, minlength=bins), moments[:, UPPER[0], UPPER[1]]


class Measurement:
    """P pairs of snapshots whose region is full: start, end (P,), grains (P,), grain_moments (P, u), pairs (P, k),
    pair_moments (P, k, u)."""

    def __init__(self, container, region):
        self._region = correlation_region(container)
        self._rows = []

    def add(self, snapshot, history):
        start = history.earlier(LAG_TAU)
        if start is None or not self._region.is_covered(snapshot.positions, 4.0):
            return
        first, second = common_grains(start.ids, snapshot.ids)
        sums = frame_sums(start.positions[first], snapshot.positions[second], snapshot.time - start.time, self._region)
        self._rows.append((start.time, snapshot.time, *sums))

    def arrays(self):
        bins, size = len(EDGES) - 1, len(UPPER[0])
        columns = list(zip(*self._rows)) or [[], [], np.empty(0, dtype=np.int64), np.empty((0, size)),
                                             np.empty((0, bins), dtype=np.int64), np.empty((0, bins, size))]
        names = ("start", "end", "grains", "grain_moments", "pairs", "pair_moments")
        return {name: np.array(column) for name, column in zip(names, columns)}


def _columns(part):
    """(P, f): the four arrays side by side, to be summed over time."""
    return np.hstack([part.grains[:, None], part.grain_moments, part.pairs,
                      part.pair_moments.reshape(len(part.grains), (len(EDGES) - 1) * len(UPPER[0]))])


def correlation(sums):
    """C (..., k) from summed ``_columns`` (..., f); not a number at distances without pairs."""
    bins, size = len(EDGES) - 1, len(UPPER[0])
    grains, own, pairs, joint = np.split(sums, np.cumsum([1, size, bins]), axis=-1)
    square = _unpack(own)
    with np.errstate(invalid="ignore", divide="ignore"):
        terms, mixed = square[..., 1:, 1:], square[..., 1:, 0]
        # the pseudo-inverse, since terms may be equal where grains stand on a lattice
        c = np.einsum("...ij,...j->...i", np.linalg.pinv(terms, hermitian=True), mixed)
        q = np.concatenate([np.ones((*c.shape[:-1], 1)), -c], axis=-1)
        variance = np.einsum("...i,...ij,...j->...", q, square, q) / grains[..., 0]
        covariance = np.einsum("...i,...bij,...j->...b", q, _unpack(joint.reshape(*joint.shape[:-1], bins, size)), q)
        return covariance / pairs / variance[..., None]


def _unpack(triangle):
    """Symmetric matrices (..., SIZE, SIZE) from their upper triangles."""
    matrix = np.zeros((*triangle.shape[:-1], SIZE, SIZE))
    matrix[..., UPPER[0], UPPER[1]] = triangle
    matrix[..., UPPER[1], UPPER[0]] = triangle
    return matrix


def middles():
    return (EDGES[1:] + EDGES[:-1]) / 2


def fitted():
    """Which bins the exponential is fitted over."""
    return (EDGES[:-1] >= FITTED[0] - 1e-9) & (EDGES[1:] <= FITTED[1] + 1e-9)


def fit(curve):
    """alpha, beta of alpha exp(-r/beta) over FITTED; curve (..., k)."""
    return fit_exponential(middles()[fitted()], curve[..., fitted()])


def mean_correlation(view):
    """C(r) over the interval, (k,); None without data."""
    part = view.run.measured[NAME]
    rows = view.pair_rows(part.start, part.end)
    return correlation(_columns(part)[rows].sum(axis=0)) if len(rows) else None


def quantities(view):
    part = view.run.measured[NAME]

    def estimate(unit, statistic):
        return view.estimate_pairs(unit, part.start, part.end, _columns(part), statistic)

    return {"correlation_length": estimate("d", lambda sums: fit(correlation(sums))[1]),
            "correlation_amplitude": estimate("1", lambda sums: fit(correlation(sums))[0])}


def between(dem, spot):
    """Root mean square of the difference of C(r) over the fitted range."""
    one, other = mean_correlation(dem), mean_correlation(spot)
    if one is None or other is None:
        return {"correlation_rms": Value("1")}
    return {"correlation_rms": Value.of("1", np.sqrt(((one - other)[fitted()]**2).mean()))}
