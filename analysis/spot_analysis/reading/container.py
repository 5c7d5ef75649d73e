# SPDX-License-Identifier: GPL-2.0-or-later
"""The silo's walls, base and orifice; lengths in d."""

from dataclasses import dataclass

import numpy as np

GRAIN_RADIUS = 0.5


@dataclass(frozen=True)
class Container:
    """Walls x = +-half_width and y = +-half_depth, base z = 0 with a circular orifice at the origin."""

    half_width: float
    half_depth: float
    orifice_radius: float

    def outside(self, positions):
        """Which centres are outside: beyond a wall, or through the base.

        positions : (n, 3); returns (n,) bool

        Grains that left through the orifice fall and spread: below the base they are looked for within 45 degrees
        of its rim, and a centre elsewhere has come through the plate.
        """
        x, y, z = positions.T
        below = z < 0
        beyond_wall = (np.abs(x) > self.half_width) | (np.abs(y) > self.half_depth)
        return np.where(below, np.hypot(x, y) > self.orifice_radius - z, beyond_wall)

    def wall_overlap(self, positions):
        """Depth to which each grain above z = 0 overlaps the walls or the base; (n,) in d, 0 where it touches none.

        The rim of the orifice is left out: in DEM it is a mesh, a polygon that may have gaps at the walls.
        """
        x, y, z = positions.T
        over_base = np.where(np.hypot(x, y) > self.orifice_radius, z, np.inf)
        distance = np.minimum.reduce([self.half_width - np.abs(x), self.half_depth - np.abs(y), over_base])
        return np.where(z > 0, np.maximum(GRAIN_RADIUS - distance, 0), 0)
