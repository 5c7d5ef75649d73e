# SPDX-License-Identifier: GPL-2.0-or-later
"""Sums over grains against their place in a period along one axis; lengths in d."""

import numpy as np

BINS = 15  # in a period
DISTANCES = BINS // 2 + 1  # different ones of the bins from the nearest end of a period; two bins each but for the last
ACROSS = 2.0  # d, width of a strip
AXES = {"x": (0, 2), "z": (2, 0)}  # the axis itself, and the one across


class Fold:
    """Sums over grains along one axis, in bins of which BINS make a period, in strips ACROSS wide."""

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
