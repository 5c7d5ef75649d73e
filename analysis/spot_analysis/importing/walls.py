# SPDX-License-Identifier: GPL-2.0-or-later
"""Walls that spot-import names or fits: what fix spot calls them, and which grains stick out. Lengths in the packing's unit."""

from dataclasses import dataclass, replace

import numpy as np

LIP = 0.1  # d


def number(value):
    """As a deck has it."""
    return f"{value + 0.0:.9g}"


def words(*values):
    return " ".join(number(value) for value in values)


def fix_words(walls, top):
    """The words of fix spot; top : height that is above all grains."""
    if walls.name != "cone":
        return f"{walls.name} {words(*walls.numbers)}"
    x, y, low, radius, base, shoulder = walls.numbers
    return f"walls add cone z {words(x, y, low, radius, base, shoulder)} walls add cylinder z {words(x, y, radius, shoulder, top)}"


@dataclass(frozen=True)
class Walls:
    """Planes and, about an upright axis, lines of (r, z) that turn about it; inside is below all of them.

    name : of the shape; numbers : those that it was made of
    planes : (k, 4), of each the horizontal outward normal x, y, of length 1, and 0, and its distance from the origin
    axis : (x, y) of the lines, or None; lines : (m, 3), of each the outward normal along r and z, and its distance
    parts : name of each wall, planes first
    base : height of the floor, or None
    orifice : (x, y, R), over which there is no floor
    """

    name: str
    numbers: tuple
    planes: np.ndarray
    axis: tuple
    lines: np.ndarray
    parts: tuple
    base: float = None
    orifice: tuple = None

    def _over_orifice(self, positions):
        return np.hypot(positions[:, 0] - self.orifice[0], positions[:, 1] - self.orifice[1]) < self.orifice[2]

    def distances(self, positions):
        """(n,) from the nearest wall, or the base, to a centre, positive inside; infinite in and below the orifice."""
        found = [plane[3] - positions @ plane[:3] for plane in self.planes]
        if len(self.lines):
            r = np.hypot(positions[:, 0] - self.axis[0], positions[:, 1] - self.axis[1])
            found += [line[2] - r * line[0] - positions[:, 2] * line[1] for line in self.lines]
        if self.base is None:
            return np.min(found, axis=0)
        height = positions[:, 2] - self.base
        over = self._over_orifice(positions)
        return np.where(over & (height < 0), np.inf, np.min([*found, np.where(over, np.inf, height)], axis=0))

    def sticking_out(self, positions, diameters):
        """(n,) how far a grain reaches beyond any wall or the base, in diameters of its own, negative inside."""
        return 0.5 - self.distances(positions) / diameters

    def inside(self, positions, inset):
        """Positions (n, 3) moved along the normals of walls and base to be at least ``inset``, (n,) or one, from each."""
        for plane in self.planes:
            beyond = np.maximum(positions @ plane[:3] + inset - plane[3], 0)
            positions = positions - beyond[:, None] * plane[:3] if beyond.any() else positions
        for line in self.lines:
            out = positions[:, :2] - self.axis
            r = np.hypot(*out.T)
            beyond = np.maximum(r * line[0] + positions[:, 2] * line[1] + inset - line[2], 0)
            if beyond.any():
                radial = out / np.maximum(r, 1e-300)[:, None] * (beyond * line[0])[:, None]
                positions = positions - np.column_stack([radial, beyond * line[1]])
        if self.base is not None:
            lifted = np.maximum(positions[:, 2], self.base + inset)
            positions = np.column_stack([positions[:, :2], np.where(self._over_orifice(positions), positions[:, 2], lifted)])
        return positions


def box(x_low, x_high, y_low, y_high):
    planes = np.array([[-1, 0, 0, -x_low], [1, 0, 0, x_high], [0, -1, 0, -y_low], [0, 1, 0, y_high]], dtype=float)
    parts = tuple(f"the wall at {axis} = {place:.6g}" for axis, place in zip("xxyy", (x_low, x_high, y_low, y_high)))
    return Walls("box", (x_low, x_high, y_low, y_high), planes, None, np.zeros((0, 3)), parts)


def cylinder(x, y, radius):
    return Walls("cylinder", (x, y, radius), np.zeros((0, 4)), (x, y), np.array([[1.0, 0.0, radius]]), (f"the cylinder of radius {radius:.6g}",))


def cone_and_cylinder(x, y, low, radius, base, shoulder):
    """A cone from radius ``low`` at height ``base`` to the cylinder, which it meets at height ``shoulder``."""
    slant = np.hypot(radius - low, shoulder - base)
    normal = np.array([shoulder - base, low - radius]) / slant
    lines = np.array([[*normal, low * normal[0] + base * normal[1]], [1.0, 0.0, radius]])
    angle = np.degrees(np.arctan2(radius - low, shoulder - base))
    parts = f"the cone of {angle:.4g} degrees", f"the cylinder of radius {radius:.6g}"
    return Walls("cone", (x, y, low, radius, base, shoulder), np.zeros((0, 4)), (x, y), lines, parts)


def around(walls, orifice, diameter):
    """The same with a base and its orifice, (x, y, z, R). A cone that ends up to LIP inside the rim ends at it."""
    if walls.name == "cone" and 0 < orifice[3] - walls.numbers[2] < LIP * diameter and walls.numbers[:2] == tuple(orifice[:2]):
        x, y, _, radius, base, shoulder = walls.numbers
        walls = cone_and_cylinder(x, y, orifice[3], radius, base, shoulder)
    return replace(walls, base=orifice[2], orifice=(orifice[0], orifice[1], orifice[3]))
