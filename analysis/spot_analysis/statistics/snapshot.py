# SPDX-License-Identifier: GPL-2.0-or-later
"""One packing in units of d and tau, with what several measurements need of it computed once."""

from functools import cached_property

import numpy as np

from . import neighbours
from .bonds import find_bonds

TIME_TOLERANCE = 0.02  # tau; decks round their timestep
LAG_TAU = 2.0  # between the snapshots that velocities are taken from; the cadence of 2006


class Snapshot:
    """time (tau); ids (n,) ascending; positions (n, 3) d, in any period; container, region: as in ``container``."""

    def __init__(self, time, ids, positions, container, region):
        self.time = time
        self.ids = ids
        self.positions = positions
        self.container = container
        self.region = region

    @cached_property
    def is_covered(self):
        """Whether the packing fills the structure region and goes on above it."""
        return self.region.is_covered(self.positions, neighbours.RDF_RANGE)

    @cached_property
    def pairs(self):
        """Pairs of the structure region within the range of g(r)."""
        return neighbours.region_pairs(self.positions, self.region, period=self.container.period)

    @cached_property
    def bonds(self):
        """Bonds of the structure region."""
        return find_bonds(self.positions, self.region, period=self.container.period)

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
