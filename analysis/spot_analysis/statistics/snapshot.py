# SPDX-License-Identifier: GPL-2.0-or-later
"""One packing in units of d and tau, with what several measurements need of it computed once, and those before it."""

from collections import deque
from functools import cached_property

import numpy as np

from . import structure
from .bonds import find_bonds

TIME_TOLERANCE = 0.02  # tau; decks round their timestep
LAG_TAU = 2.0  # between the snapshots that velocities are taken from; the cadence of 2006


class Snapshot:
    """time (tau); ids (n,) ascending; positions (n, 3) d; container, region: as in ``container``."""

    def __init__(self, time, ids, positions, container, region):
        self.time = time
        self.ids = ids
        self.positions = positions
        self.container = container
        self.region = region

    @cached_property
    def is_covered(self):
        """Whether the packing fills the structure region and goes on above it."""
        return self.region.is_covered(self.positions, structure.RDF_RANGE)

    @cached_property
    def pairs(self):
        """Pairs of the structure region within the range of g(r)."""
        return structure.region_pairs(self.positions, self.region)

    @cached_property
    def bonds(self):
        """Bonds of the structure region."""
        return find_bonds(self.positions, self.region)

    def forget(self):
        """Free the pairs and bonds; they are made again when asked for."""
        for name in ("pairs", "bonds"):
            self.__dict__.pop(name, None)

    def index_of(self, ids):
        """Where the ids stand in this snapshot, (m,) int64; -1 for those that are not in it."""
        if not len(self.ids):
            return np.full(len(ids), -1)
        place = np.searchsorted(self.ids, ids).clip(0, len(self.ids) - 1)
        return np.where(self.ids[place] == ids, place, -1)


class History:
    """The first snapshot, the newest, the one before and those of the last ``span`` tau."""

    def __init__(self, span):
        self._span = span
        self._recent = deque()
        self.first = None

    def add(self, snapshot):
        self.first = self.first or snapshot
        self._recent.append(snapshot)
        while len(self._recent) > 2 and self._recent[0].time < snapshot.time - self._span - TIME_TOLERANCE:
            self._recent.popleft()

    @property
    def previous(self):
        """The snapshot before the newest, None if the newest is the first."""
        return self._recent[-2] if len(self._recent) > 1 else None

    def earlier(self, lag):
        """The snapshot ``lag`` tau before the newest; None if there is none."""
        wanted = self._recent[-1].time - lag
        return next((one for one in self._recent if abs(one.time - wanted) <= TIME_TOLERANCE), None)

    def since(self, time):
        """The snapshots from ``time`` to the newest."""
        return [one for one in self._recent if one.time >= time - TIME_TOLERANCE]
