# SPDX-License-Identifier: GPL-2.0-or-later
"""Mixing of horizontal layers: what lies side by side, and from which height comes what has left."""

import math

import numpy as np

from .value import Value

NAME = "mixing"
LAYER = 10.0  # d; layers whose grains count as different
BAND = 2.0  # d; bands of starting height that drained grains are counted in
MEANING = {
    "unlike_neighbours": "share that started in another layer of 10 d",
    "drained_height_mean": "starting height of the drained grains",
    "drained_height_spread": "its standard deviation",
}
NEEDS = {"unlike_neighbours": ("structure",), "*": ("outflow",)}


def unlike_share(bonds, layers):
    """Share of the bonds with a grain in the region that join grains of different layers; layers (n,) by grain of the
    packing, negative where unknown. Not a number without bonds."""
    one, other = layers[bonds.grains[bonds.first]], layers[bonds.grains[bonds.second]]
    counted = (bonds.inside[bonds.first] | bonds.inside[bonds.second]) & (one >= 0) & (other >= 0)
    return float((one != other)[counted].mean()) if counted.any() else math.nan


class Measurement:
    """times (T,); unlike (T,): share of unlike bonds, not a number where the structure region is not full; left (T, B):
    grains still above z = 0, by the band of BAND in which they were in the first snapshot."""

    def __init__(self, container, region):
        self._times, self._unlike, self._left = [], [], []

    def add(self, snapshot, history):
        first = history.first
        start = np.maximum(first.positions[:, 2], 0)
        origin = first.index_of(snapshot.ids)
        layers = np.full(len(origin), -1)
        layers[origin >= 0] = (start / LAYER).astype(np.int64)[origin[origin >= 0]]
        above = (snapshot.positions[:, 2] > 0) & (origin >= 0)
        bands = int(start.max(initial=0) / BAND) + 1
        self._times.append(snapshot.time)
        self._unlike.append(unlike_share(snapshot.bonds, layers) if snapshot.is_covered else math.nan)
        self._left.append(np.bincount((start / BAND).astype(np.int64)[origin[above]], minlength=bands))

    def arrays(self):
        return {"times": np.array(self._times), "unlike": np.array(self._unlike), "left": np.array(self._left)}


def drained(view):
    """Starting heights (B,) and grains that drained from each band up to the last common time (B,)."""
    part = view.run.measured[NAME]
    common = view.common
    lost = part.left[common[0]] - part.left[common[-1]]
    return (np.arange(part.left.shape[1]) + 0.5) * BAND, lost


def quantities(view):
    part = view.run.measured[NAME]
    height, lost = drained(view)
    mean = spread = math.nan
    if lost.sum() > 0:
        mean = (lost * height).sum() / lost.sum()
        spread = math.sqrt((lost * (height - mean)**2).sum() / lost.sum())
    return {"unlike_neighbours": view.mean_of("1", part.times, part.unlike),
            "drained_height_mean": Value.of("d", mean), "drained_height_spread": Value.of("d", spread)}
