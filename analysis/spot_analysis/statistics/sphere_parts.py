# SPDX-License-Identifier: GPL-2.0-or-later
"""Volumes of grains, of diameter 1, as far as they are inside a room that is round about the z axis; lengths in d."""

import numpy as np
from scipy.integrate import quad

NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)


def volume_inside(positions, low, high, radius_at):
    """Volume (n,), d^3, of each grain that is inside low < z < high and r < radius_at(z).

    positions : (n, 3); radius_at : function of heights, an array of any shape

    Horizontal cuts of a grain are circles, and what is inside of them is a lens. It is integrated over the height by
    Gauss' rule, exactly where the grain is cut by no side.
    """
    axis, z = np.hypot(positions[:, 0], positions[:, 1]), positions[:, 2]
    bottom, top = np.maximum(low, z - 0.5), np.minimum(high, z + 0.5)
    half = np.maximum(top - bottom, 0)[:, None] / 2
    heights = (top + bottom)[:, None] / 2 + half * NODES
    cut = np.sqrt(np.maximum(0.25 - (heights - z[:, None]) ** 2, 0))
    return np.sum(half * WEIGHTS * lens_area(cut, radius_at(heights), axis[:, None]), axis=1)


def lens_area(one, other, apart):
    """Area that two circles have in common, with their radii and how far their middles are apart; arrays of one
    shape."""
    one, other, apart = np.broadcast_arrays(one, other, apart)
    smaller = np.minimum(one, other)
    area = np.where(apart <= np.abs(one - other), np.pi * smaller ** 2, 0.0)
    cross = (apart > np.abs(one - other)) & (apart < one + other)
    a, b, d = one[cross], other[cross], apart[cross]
    kite = np.sqrt(np.maximum((-d + a + b) * (d + a - b) * (d - a + b) * (d + a + b), 0))
    angle_a, angle_b = (np.arccos(np.clip((d * d + p * p - q * q) / (2 * d * p), -1, 1)) for p, q in ((a, b), (b, a)))
    area[cross] = a * a * angle_a + b * b * angle_b - kite / 2
    return area


def room(low, high, radius_at, kinks=()):
    """Volume of the room, d^3. kinks : heights at which its side has an edge"""
    inside = [kink for kink in kinks if low < kink < high]
    return quad(lambda z: np.pi * radius_at(z) ** 2, low, high, points=inside or None)[0]
