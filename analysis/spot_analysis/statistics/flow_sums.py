# SPDX-License-Identifier: GPL-2.0-or-later
"""Sums over intervals of a drainage, from which ``flow_fields`` are taken; lengths in d, times in tau.

In bins of 1 d by 1 d in x and z, from wall to wall in y. Velocities are displacements between snapshots LAG_TAU apart, and stand at
the middle of the displacement.
"""

import math

import numpy as np
from scipy.ndimage import map_coordinates

from ..base.errors import AnalysisError
from .flow import common_grains
from .flow_fields import at_rest, fields_of, smooth, top_of
from .snapshot import LAG_TAU, TIME_TOLERANCE


class Measurement:
    """Takes all snapshots of a run in order, from the packing at rest on.

    intervals : (start, end) in tau

    Raises AnalysisError where that packing is without grains.
    """

    def __init__(self, container, intervals):
        self.intervals = [tuple(interval) for interval in intervals]
        self._half = math.ceil(container.half_width)
        self._bin_volume = 2 * container.half_depth
        self._sums = [{} for _ in self.intervals]
        self._lowest = [None for _ in self.intervals]
        self._last = None

    def add(self, snapshot):
        if self._last is None:
            self._start(snapshot)
        else:
            self._step(self._last, snapshot)
        counts = self._histogram(snapshot.positions)
        t = snapshot.time
        for number in self._of(t, t):
            self._add(number, {"snapshots": 1.0, "t": t, "tt": t * t, "grains": counts, "t grains": t * counts})
            lowest = self._lowest[number]
            self._lowest[number] = counts if lowest is None else np.minimum(lowest, counts)
        self._last = snapshot

    def pairs(self, number):
        """How many displacements over LAG_TAU interval ``number`` holds."""
        return self._sums[number].get("pairs", 0)

    def drained(self, number):
        """Grains that have left the box, on average over the snapshots of the interval."""
        sums = self._sums[number]
        return float(self._at_rest.sum() - sums["grains"].sum() / sums["snapshots"])

    def fields(self, number, side=0):
        """FlowFields of interval number ``number``; of both sides, or of x < 0 (-1) or x > 0 (1) alone."""
        sums = {name: self._folded(value, -1 if name == "v_x" else 1, side) if np.ndim(value) else value
                for name, value in self._sums[number].items()}
        return fields_of(sums, self._rest(side), math.pi / 6 / self._bin_volume, top_of(self._lowest[number]))

    def _start(self, snapshot):
        if not len(snapshot.ids):
            raise AnalysisError("the first snapshot, the packing at rest, is without grains")
        self._height = max(1, math.ceil(snapshot.positions[:, 2].max()))
        self._edges = np.arange(-self._half, self._half + 1), np.arange(self._height + 1)
        self._at_rest = self._histogram(snapshot.positions)
        self._ids, self._origin = snapshot.ids, snapshot.positions[:, 2]
        self._strain = np.zeros(len(snapshot.ids))

    def _histogram(self, positions, weights=None):
        return np.histogram2d(positions[:, 0], positions[:, 2], self._edges, weights=weights)[0]

    def _step(self, before, after):
        first, second = common_grains(before.ids, after.ids)
        start, end, duration = before.positions[first], after.positions[second], after.time - before.time
        middle, velocity = (start + end) / 2, (end - start) / duration
        known = self._known(before.ids[first])
        sums = {"moved": self._histogram(middle), "v_x": self._histogram(middle, velocity[:, 0]),
                "u": self._histogram(middle, -velocity[:, 2]), "strain": self._histogram(middle, self._strain[known]),
                "fallen": self._histogram(middle, self._origin[known] - middle[:, 2])}
        if abs(duration - LAG_TAU) <= TIME_TOLERANCE:
            for number in self._of(before.time, after.time):
                self._add(number, {**sums, "pairs": 1})
        shear = np.abs(np.gradient(smooth(sums["u"]) / np.maximum(smooth(sums["moved"]), 1e-9), axis=0))
        places = np.stack([middle[:, 0] + self._half, middle[:, 2]]) - 0.5
        self._strain[known] += map_coordinates(shear, places, order=1, mode="nearest") * duration

    def _known(self, ids):
        """Where grains stand in the packing at rest; raises AnalysisError where they came in later."""
        place = np.searchsorted(self._ids, ids).clip(0, len(self._ids) - 1)
        if not np.array_equal(self._ids[place], ids):
            raise AnalysisError("grains came in after the first snapshot: how far they fell since the start is unknown")
        return place

    def _of(self, start, end):
        return [number for number, (low, high) in enumerate(self.intervals)
                if start >= low - TIME_TOLERANCE and end <= high + TIME_TOLERANCE]

    def _add(self, number, sums):
        for name, value in sums.items():
            self._sums[number][name] = self._sums[number].get(name, 0) + value

    def _folded(self, values, sign, side):
        """(2 X, Z) with left and right alike, so that smoothing knows no edge on the axis."""
        other = sign * values[::-1]
        if side == 0:
            return (values + other) / 2
        right = (values if side > 0 else other)[self._half:]
        return np.concatenate([sign * right[::-1], right])

    def _rest(self, side):
        grains = self._folded(self._at_rest, 1, side)
        return at_rest(grains, np.arange(self._height) + 0.5, top_of(self._at_rest))
