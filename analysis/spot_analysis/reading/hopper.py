# SPDX-License-Identifier: GPL-2.0-or-later
"""The walls of a hopper: a cone under an upright cylinder, open below; lengths in d."""

from dataclasses import dataclass, replace

import numpy as np

CURVE = 60  # points of a wall that is cut beside the axis


@dataclass(frozen=True)
class Hopper:
    """About the axis x = y = 0. The cone's radius grows from orifice_radius at z = 0 to cylinder_radius at cone_height.

    section : y of the upright section that is drawn
    """

    orifice_radius: float
    cylinder_radius: float
    cone_height: float
    section: float = 0.0

    def cut(self, slab):
        """The same, drawn where the slab (low, high) along y is widest; None is the axis."""
        return replace(self, section=0.0 if slab is None else float(np.clip(0.0, *slab)))

    @property
    def half_width(self):
        """Of the section, at its widest."""
        return self._half_width(self.cylinder_radius)

    def _half_width(self, radius):
        return np.sqrt(np.maximum(np.square(radius) - self.section**2, 0.0))

    def lines(self, top):
        """Walls of the section up to the height ``top``: x and z of the points of each, two arrays."""
        if abs(self.section) >= self.cylinder_radius:
            return []
        lowest = np.clip((abs(self.section) - self.orifice_radius) / (self.cylinder_radius - self.orifice_radius), 0, 1)
        z = np.append(np.linspace(lowest, 1, CURVE) * self.cone_height, max(top, self.cone_height))
        share = np.minimum(z / self.cone_height, 1)
        radius = self.orifice_radius + (self.cylinder_radius - self.orifice_radius) * share
        x = self._half_width(radius)
        return [(side * x, z) for side in (-1, 1)]

    def images(self, positions, reach):
        """Mirror images (m, 3) of the positions (n, 3) closer to a wall than ``reach``, each in its own tangent plane."""
        r = np.hypot(*positions.T[:2])
        slant = np.hypot(self.cone_height, self.cylinder_radius - self.orifice_radius)
        cone = np.array([self.cone_height, self.orifice_radius - self.cylinder_radius]) / slant  # outwards: r and z
        found = []
        for normal, wall in ((cone, self.orifice_radius * cone[0]), ((1.0, 0.0), self.cylinder_radius)):
            distance = wall - normal[0] * r - normal[1] * positions[:, 2]
            near = (np.abs(distance) < reach) & (positions[:, 2] > 0) & (r > 0)
            radial = positions[near, :2] * (normal[0] / r[near])[:, None]
            outwards = np.column_stack([radial, np.full(near.sum(), normal[1])])
            found.append(positions[near] + 2 * distance[near, None] * outwards)
        return np.vstack(found)
