# SPDX-License-Identifier: GPL-2.0-or-later
"""g3(theta): distribution of the angles between two bonds of one grain (2006)."""

import numpy as np

from .bonds import directions_by_grain
from .value import Value

NAME = "bond_angles"
BINS = 180  # of 1 degree
REBIN = 2  # bins in one of those that are compared
EDGES = np.linspace(0, 180, BINS // REBIN + 1)  # degrees
MEANING = {
    "g3_l2_initial": "rms change of g3 since the start",
    "g3_l2": "rms difference of g3, spot and DEM",
    "g3_l2_ratio": "g3_l2 over DEM's g3_l2_initial",
}
NEEDS = {"*": ("structure",)}


def angle_counts(bonds):
    """Angles between the bonds of each grain of the region, (BINS,) int64; n bonds make n (n - 1) / 2 angles."""
    table = directions_by_grain(bonds)
    one, other = np.triu_indices(table.shape[1], 1)
    exists = np.abs(table).sum(axis=2) > 0
    cosine = np.einsum("npk,npk->np", table[:, one], table[:, other])[exists[:, one] & exists[:, other]]
    # an angle of exactly 60 degrees must not depend on rounding
    degrees = np.degrees(np.arccos(np.clip(cosine, -1, 1))) + 1e-7
    return np.bincount(np.minimum(degrees * (BINS / 180), BINS - 1).astype(np.int64), minlength=BINS)


class Measurement:
    """counts : (T, BINS), 0 where the region is not full; times : (T,)"""

    def __init__(self, container, region):
        self._times, self._counts = [], []

    def add(self, snapshot, history):
        self._times.append(snapshot.time)
        self._counts.append(angle_counts(snapshot.bonds) if snapshot.is_covered else np.zeros(BINS, dtype=np.int64))

    def arrays(self):
        return {"times": np.array(self._times), "counts": np.array(self._counts).reshape(-1, BINS)}


def density(counts):
    """Probability density over the angle, per degree, in the bins of EDGES; counts (..., BINS) of ``angle_counts``."""
    wide = counts.reshape(*counts.shape[:-1], -1, REBIN).sum(axis=-1)
    with np.errstate(invalid="ignore", divide="ignore"):
        return wide / wide.sum(axis=-1, keepdims=True) / np.diff(EDGES)


def distance(one, other):
    """Root mean square of the difference of two densities (..., bins), over the angles that two bonds can make."""
    possible = EDGES[:-1] >= 40
    return np.sqrt(((one - other)[..., possible]**2).mean(axis=-1))


def mean_density(view):
    """The density over the interval."""
    part = view.run.measured[NAME]
    return density(part.counts[view.rows(part.times)].sum(axis=0))


def initial_density(view):
    return density(view.run.measured[NAME].counts[0])


def quantities(view):
    part = view.run.measured[NAME]
    initial = initial_density(view)
    return {"g3_l2_initial": view.estimate("1/deg", part.times, part.counts,
                                           lambda sums: distance(density(sums), initial))}


def between(dem, spot):
    """What needs both runs."""
    apart = float(distance(mean_density(dem), mean_density(spot)))
    change = float(distance(mean_density(dem), initial_density(dem)))
    return {"g3_l2": Value.of("1/deg", apart), "g3_l2_ratio": Value.of("1", apart / change if change else np.nan)}
