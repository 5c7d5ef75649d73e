# SPDX-License-Identifier: GPL-2.0-or-later
"""Do grains know where the cells begin in which the windowed driver relaxes them? Lengths in d.

The cells are cubes of EDGE; the grid begins at the lowest x and y of any grain at the start, and at the outlet. Along x or z the
grains are put into bins by their distance to the nearest edge of a cell, and in every bin are counted, with their overlaps and
their motion sideways about the mean flow, each less its mean over the length of a cell around, so that what changes slowly over
the silo does not look like an imprint. Without one, nothing is left.

What is known of the scatter comes from blocks, several cells long: what grains of one block do is tied together by their
neighbours, over snapshots, and over runs from the same packing. So a block is one sample, summed over all of these.
"""

from dataclasses import dataclass

import numpy as np
from scipy import linalg, stats

from ..base.errors import AnalysisError
from ..reading.container import Region
from .mean_flow import UPPER, WALL_LAYER, Step, about_mean_flow
from .snapshot import LAG_TAU
from .structure import close_pairs

EDGE = 1.5
BINS = 15  # in a cell
DISTANCES = (np.arange(BINS // 2 + 1) + 0.5) / BINS * EDGE  # middles of the bins, which are two each but for the last
HALF_WIDTH, BOTTOM, TOP = 15.0, 25.0, 66.0  # of the bulk, in steady flow, far from side walls, outlet and surface
CELLS, ACROSS = 4, 2.0  # size of a block: in cells along the axis, in d across
AXES = {"x": (0, 2), "z": (2, 0)}  # the axis itself, and the one across
QUANTITIES = ("grains", "overlap", "sideways")


def bulk(container):
    return Region(min(HALF_WIDTH, 0.6 * container.half_width), BOTTOM, TOP, container.half_depth - WALL_LAYER)


class Fold:
    """Sums over grains along one axis, in bins of which BINS make a cell, in strips ACROSS wide."""

    def __init__(self, axis, origin, period, region):
        low, high = np.array([-region.half_width, 0, region.bottom]), np.array([region.half_width, 0, region.top])
        self._axes = AXES[axis]
        along, across = self._axes
        self._start = origin[along] + np.ceil((low[along] - origin[along]) / period) * period, low[across]
        self._size = period / BINS, ACROSS
        cells, strips = int((high[along] - self._start[0]) / period), int((high[across] - low[across]) / ACROSS)
        self._shape = cells * BINS, strips
        self._sums = {}

    def add(self, name, positions, values):
        """values : (n, k) of grains at positions (n, 3)"""
        place = np.stack([(positions[:, a] - start) / size for a, start, size in zip(self._axes, self._start, self._size)])
        along, across = np.floor(place).astype(np.int64)
        inside = (along >= 0) & (along < self._shape[0]) & (across >= 0) & (across < self._shape[1])
        index = across[inside] * self._shape[0] + along[inside]
        sums = np.stack([np.bincount(index, column, self._shape[0] * self._shape[1]) for column in values[inside].T], axis=-1)
        self._sums[name] = self._sums.get(name, 0) + sums

    def has(self, name):
        return name in self._sums

    def sums(self, name):
        """(strips, bins along the axis, k)"""
        return self._sums[name].reshape(self._shape[1], self._shape[0], -1)


@dataclass(frozen=True)
class Imprint:
    """profile, error : at DISTANCES, a quantity over its mean, with standard errors
    chi_square : of the profile against a flat one, with one degree of freedom less than bins, whose correlations are included
    p_value : chance of more without an imprint, by Hotelling's distribution, since the scatter is estimated too
    """

    profile: np.ndarray
    error: np.ndarray
    chi_square: float
    p_value: float
    blocks: int

    def depth(self):
        """Root mean square deviation from 1, and what scatter alone makes of it."""
        return np.sqrt(((self.profile - 1)**2).mean()), np.sqrt((self.error**2).mean())


def around(sums):
    """Mean over the length of a cell around each bin (strips, bins), without the outermost cells."""
    total = np.cumsum(np.pad(sums, ((0, 0), (1, 0))), axis=1)
    means = (total[:, BINS:] - total[:, :-BINS]) / BINS
    return means[:, BINS - BINS // 2:][:, :sums.shape[1] - 2 * BINS]


def imprint(sums, grains):
    """The Imprint of what is summed (strips, bins) over so many grains."""
    off = sums[:, BINS:-BINS] - around(sums) / around(grains) * grains[:, BINS:-BINS]
    cells = off.shape[1] // BINS // CELLS * CELLS
    off = off[:, :cells * BINS].reshape(-1, CELLS, BINS).sum(axis=1)
    off = (off + off[:, ::-1])[:, :len(DISTANCES)] / 2
    weight = np.where(np.arange(len(DISTANCES)) < BINS // 2, 2, 1)  # bins at this distance
    off -= (off @ weight / BINS)[:, None]
    blocks, freedom, scale = len(off), len(DISTANCES) - 1, sums[:, BINS:(cells + 1) * BINS].sum() / BINS
    if len(off) <= len(DISTANCES):
        raise AnalysisError(f"{len(off)} blocks are too few for the scatter of {len(DISTANCES)} bins: the silo is too narrow")
    samples = off @ linalg.null_space(weight[None].astype(float))
    mean = samples.mean(axis=0)
    chi_square = float(mean @ np.linalg.solve(np.cov(samples.T) / blocks, mean))
    return Imprint(1 + off.sum(axis=0) / scale, off.std(axis=0, ddof=1) * np.sqrt(blocks) / scale, chi_square,
                   float(stats.f.sf(chi_square * (blocks - freedom) / (freedom * (blocks - 1)), freedom, blocks - freedom)), blocks)


def squared_overlaps(positions):
    """(n,) sum over a grain's neighbours"""
    first, second = close_pairs(positions, 1.0)
    squares = (1 - np.linalg.norm(positions[first] - positions[second], axis=1))**2
    return np.bincount(first, squares, len(positions)) + np.bincount(second, squares, len(positions))


class Measurement:
    """Adds up snapshots of one or more runs for both axes and for several periods, of which EDGE is the cells' own."""

    def __init__(self, container, periods=(EDGE,)):
        self._region = bulk(container)
        self._periods = periods
        self._folds = {}

    def start(self, positions, outlet=0.0):
        """Of a run, with the packing that its cells were made for; raises AnalysisError where that is without grains."""
        if not len(positions):
            raise AnalysisError("the first snapshot, whose lowest x and y are where the cells begin, is without grains")
        origin = np.array([*positions[:, :2].min(axis=0), outlet])
        self._run = {(axis, period): Fold(axis, origin, period, self._region) for axis in AXES for period in self._periods}
        for key, fold in self._run.items():
            self._folds.setdefault(key, []).append(fold)

    def add(self, snapshot, earlier):
        """earlier : Snapshot some time before, or None"""
        positions = snapshot.positions[self._region.contains(snapshot.positions, margin=1.0)]
        overlaps = squared_overlaps(positions)
        inside = self._region.contains(positions)
        positions, overlaps = positions[inside], overlaps[inside]
        step = earlier and Step(earlier, snapshot, self._region)
        for fold in self._run.values():
            fold.add("overlap", positions, np.column_stack([np.ones(len(positions)), overlaps]))
            if step:
                w = step.w[step.inside]
                fold.add("sideways", step.middle[step.inside],
                         np.column_stack([np.ones(len(w)), w[:, UPPER[0]] * w[:, UPPER[1]]]))

    def imprints(self):
        """(axis, period) -> quantity -> Imprint; raises AnalysisError where too little was added for one."""
        if not all(fold.has("sideways") for folds in self._folds.values() for fold in folds):
            raise AnalysisError(f"no two snapshots of the interval are {LAG_TAU:g} tau apart, from which motion is taken")
        found = {}
        for key, folds in self._folds.items():
            overlap, sideways = (sum(fold.sums(name) for fold in folds) for name in ("overlap", "sideways"))
            grains, products = overlap[..., 0], sideways[..., 1:]
            if not (grains.any() and sideways[..., 0].any()):
                raise AnalysisError(f"no grains in the bulk, {BOTTOM:g} d < z < {TOP:g} d, in the interval")
            squares = about_mean_flow(products.sum(axis=(0, 1)), products.reshape(-1, products.shape[-1])).reshape(products.shape[:2])
            found[key] = {"grains": imprint(grains, np.ones_like(grains)), "overlap": imprint(overlap[..., 1], grains),
                          "sideways": imprint(squares, sideways[..., 0])}
        return found
