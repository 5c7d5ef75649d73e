# SPDX-License-Identifier: GPL-2.0-or-later
"""Do grains know where the cells begin in which the windowed driver relaxes them? Lengths in d.

The cells are cubes of EDGE; the grid begins at the lowest x and y of any grain at the start, and at the outlet. Along x or z the
grains are put into bins by their distance to the nearest edge of a cell, and in every bin are counted, with their overlaps and
their motion sideways about the mean flow, each less its mean over the length of a cell around, so that what changes slowly over
the silo does not look like an imprint. Without one, nothing is left.
"""

import numpy as np

from ..base.errors import AnalysisError
from .fold import AXES, BINS, DISTANCES, Fold
from .imprint import imprint
from .mean_flow import UPPER, WALL_LAYER, Step, about_mean_flow
from .neighbours import close_pairs
from .region import Region
from .snapshot import LAG_TAU

EDGE = 1.5
DISTANCE = (np.arange(DISTANCES) + 0.5) / BINS * EDGE  # of the bins' middles from the nearest edge
HALF_WIDTH, BOTTOM, TOP = 15.0, 25.0, 66.0  # of the bulk, in steady flow, far from side walls, outlet and surface
QUANTITIES = ("grains", "overlap", "sideways")


def bulk(container):
    return Region(min(HALF_WIDTH, 0.6 * container.half_width), BOTTOM, TOP, container.half_depth - WALL_LAYER)


def squared_overlaps(positions):
    """(n,) sum over a grain's neighbours"""
    first, second = close_pairs(positions, 1.0)
    squares = (1 - np.linalg.norm(positions[first] - positions[second], axis=1))**2
    return np.bincount(first, squares, len(positions)) + np.bincount(second, squares, len(positions))


class Measurement:
    """Adds up snapshots of one or more runs for both axes and for several periods, of which EDGE is the cells' own."""

    def __init__(self, container, periods=(EDGE,)):
        if container.periodic:
            raise AnalysisError("the silo is periodic along y, but the imprint is looked for between walls there")
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
