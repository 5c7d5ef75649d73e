# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures of the layer of grains at the front wall, y = -half_depth; where there is none, of that around y = 0."""

import numpy as np

from .run_statistics import PICTURE_QUANTUM
from .snapshot import TIME_TOLERANCE

PICTURE_PERIOD = 10.0  # tau; after PICTURE_MANY only every PICTURE_SPARSE
PICTURE_MANY = 100.0
PICTURE_SPARSE = 100.0
LAYER_HEIGHT = 10.0  # d


class FrontLayer:
    """Takes a picture of some of the snapshots; each grain keeps the colour of the layer that it started in."""

    def __init__(self, container):
        self._container = container
        self._times = []
        self._parts = []

    def add(self, snapshot, first):
        """first : Snapshot at the start of the run"""
        if _is_picture_time(snapshot.time):
            self._times.append(snapshot.time)
            self._parts.append(self._layer(snapshot, first))

    def _layer(self, snapshot, first):
        """x, z (PICTURE_QUANTUM) and starting layer of the grains of the layer, d thick."""
        positions = self._container.in_period(snapshot.positions)
        y = positions[:, 1]
        inside = np.abs(y) < 0.5 if self._container.periodic else y < 1 - self._container.half_depth
        front = inside & (positions[:, 2] > -1)
        place = first.index_of(snapshot.ids[front])
        layer = np.full(len(place), -1)
        layer[place >= 0] = np.maximum(first.positions[place[place >= 0], 2] / LAYER_HEIGHT, 0).astype(np.int64)
        x, _, z = np.rint(positions[front] / PICTURE_QUANTUM).astype(np.int64).T
        order = np.argsort(z, kind="stable")  # neighbours in the file look alike, so it compresses better
        return x[order], z[order], layer[order]

    def arrays(self):
        """The arrays of ``RunStatistics`` that begin with picture_."""
        x, z, layer = (np.concatenate([np.empty(0, dtype=np.int64), *part]) for part in list(zip(*self._parts)) or 3 * [()])
        sizes = np.array([len(part[0]) for part in self._parts], dtype=np.int64)
        return {"picture_times": np.array(self._times), "picture_sizes": sizes, "picture_x": x, "picture_z": z,
                "picture_layer": layer}


def _is_picture_time(time):
    period = PICTURE_PERIOD if time < PICTURE_MANY + TIME_TOLERANCE else PICTURE_SPARSE
    return abs(time - period * round(time / period)) <= TIME_TOLERANCE
