# SPDX-License-Identifier: GPL-2.0-or-later
"""The silo's walls, base and orifice, and where it repeats; lengths in d."""

from dataclasses import dataclass

import numpy as np

from ..base.errors import SceneError

GRAIN_RADIUS = 0.5


def nearest_image(differences, period):
    """Differences of positions, or positions as seen from the origin, (n, 3), to the nearest image along y; period : None where
    nothing repeats."""
    if period is None:
        return differences
    shortened = differences.copy()
    shortened[:, 1] -= period * np.rint(differences[:, 1] / period)
    return shortened


def check_orifices(orifices, slot):
    """Raises SceneError for what a scene file cannot say of them."""
    if isinstance(orifices, bool) or not isinstance(orifices, int) or orifices < 1:
        raise SceneError(f"scene: 'orifices' must be a whole number from 1 on, not {orifices!r}")
    if not isinstance(slot, bool):
        raise SceneError(f"scene: 'slot' must be true or false, not {slot!r}")


@dataclass(frozen=True)
class Container:
    """Walls x = +-half_width and y = +-half_depth, base z = 0 with a circular orifice at the origin, or with several.

    periodic : there are no walls across y, along which the silo repeats every 2 half_depth. Positions may then be in any period.
    orifices : how many, in the middles of equal parts of the base along x; only ``middles`` and pictures know of more than one
    """

    half_width: float
    half_depth: float
    orifice_radius: float
    periodic: bool = False
    orifices: int = 1

    @property
    def middles(self):
        """x of the orifices' middles."""
        return tuple((2 * k + 1 - self.orifices) * self.half_width / self.orifices for k in range(self.orifices))

    def cut(self, slab):
        """The walls that are drawn of a slab (low, high) along y."""
        return self

    def lines(self, top):
        """Walls, up to the height ``top``, and base as seen along y: x and z of the ends of each, two lists."""
        rims = [x + side * self.orifice_radius for x in self.middles for side in (-1, 1)]
        ends = [-self.half_width, *rims, self.half_width]
        return [([x, x], [0, top]) for x in (-self.half_width, self.half_width)] + \
            [(list(part), [0, 0]) for part in zip(ends[::2], ends[1::2])]

    @property
    def period(self):
        """Of y; None where there are walls."""
        return 2 * self.half_depth if self.periodic else None

    def depth_off_walls(self, layer):
        """|y| up to which grains are at least ``layer`` from walls across y; infinite where there are none."""
        return np.inf if self.periodic else self.half_depth - layer

    def in_period(self, positions):
        """Positions (n, 3) with |y| <= half_depth, where the silo repeats; as they are otherwise."""
        return nearest_image(positions, self.period)

    def outside(self, positions):
        """Which centres are outside: beyond a wall, or through the base.

        positions : (n, 3); returns (n,) bool

        Grains that left through the orifice fall and spread: below the base they are looked for within 45 degrees
        of its rim, and a centre elsewhere has come through the plate.
        """
        x, y, z = self.in_period(positions).T
        below = z < 0
        beyond_wall = (np.abs(x) > self.half_width) | (np.abs(y) > self.depth_off_walls(0))
        return np.where(below, np.hypot(x, y) > self.orifice_radius - z, beyond_wall)

    def wall_overlap(self, positions):
        """Depth to which each grain above z = 0 overlaps the walls or the base; (n,) in d, 0 where it touches none.

        The rim of the orifice is left out: in DEM it is a mesh, a polygon that may have gaps at the walls.
        """
        x, y, z = self.in_period(positions).T
        over_base = np.where(np.hypot(x, y) > self.orifice_radius, z, np.inf)
        distance = np.minimum.reduce([self.half_width - np.abs(x), self.depth_off_walls(0) - np.abs(y), over_base])
        return np.where(z > 0, np.maximum(GRAIN_RADIUS - distance, 0), 0)
