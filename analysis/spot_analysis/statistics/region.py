# SPDX-License-Identifier: GPL-2.0-or-later
"""The regions in which statistics are taken; lengths in d."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Region:
    """The box |x| < half_width, bottom < z < top, |y| < half_depth: from wall to wall by default."""

    half_width: float
    bottom: float
    top: float
    half_depth: float = np.inf

    def contains(self, positions, margin=0.0):
        """(n,) bool: centres inside, or within ``margin`` of it along x and z."""
        x, y, z = positions.T
        return ((np.abs(x) < self.half_width + margin) & (np.abs(y) < self.half_depth)
                & (z > self.bottom - margin) & (z < self.top + margin))

    def area(self):
        """In the plane of x and z, d^2."""
        return 2 * self.half_width * (self.top - self.bottom)

    def is_covered(self, positions, depth):
        """Whether the packing goes on for about ``depth`` above the top, so that every grain has its partners."""
        above = Region(self.half_width, self.top, self.top + depth).contains(positions).sum()
        below = Region(self.half_width, self.top - depth, self.top).contains(positions).sum()
        return bool(above > 0.75 * below > 0)


def structure_region(container):
    """Where 2006 takes g(r): |x| < 15 d, 15 d < z < 45 d; in a narrower silo the same share of its width."""
    return Region(0.6 * container.half_width, 15.0, 45.0)
