# SPDX-License-Identifier: GPL-2.0-or-later
"""Shape and angle of the free surface, as 2010 measures it."""

import numpy as np

from .fits import fit_line

NAME = "free_surface"
STEP = 2.5  # d
MEANING = {
    "surface_angle": "of the free surface, mean",
    "surface_angle_last": "at the last common time",
    "surface_height_axis": "highest grain, |x| < 2.5 d, then",
    "surface_height_wall": "highest grain within 2.5 d of a side wall, then",
}
NEEDS = {"*": ("grains",)}


def places(container):
    """x_j = (2.5 j - 1.25) d; j = 1..10 in the silo of 2010, as many as fit into another."""
    return (np.arange(int(container.half_width / STEP + 1e-9)) + 0.5) * STEP


def surface_heights(positions, at):
    """Height of the highest grain within 1.25 d of |x| = x_j, (j,) d; not a number where there is none."""
    strip = (np.abs(positions[:, 0]) / STEP).astype(np.int64)
    inside = strip < len(at)
    heights = np.full(len(at), -np.inf)
    np.maximum.at(heights, strip[inside], positions[inside, 2])
    return np.where(np.isfinite(heights), heights, np.nan)


def angle(at, heights):
    """Slope of the straight line through the heights (..., j), as an angle in degrees (...); positive where the
    surface rises towards the walls."""
    if len(at) < 2:
        return np.full(heights.shape[:-1], np.nan)
    return np.degrees(np.arctan(fit_line(at, heights)[0]))


class Measurement:
    """x : (J,); heights : (T, J); times : (T,)"""

    def __init__(self, container, region):
        self._at = places(container)
        self._times, self._heights = [], []

    def add(self, snapshot, history):
        self._times.append(snapshot.time)
        self._heights.append(surface_heights(snapshot.positions, self._at))

    def arrays(self):
        return {"times": np.array(self._times), "x": self._at,
                "heights": np.array(self._heights).reshape(-1, len(self._at))}


def quantities(view):
    part = view.run.measured[NAME]
    angles = angle(part.x, part.heights)
    return {"surface_angle": view.mean_of("deg", part.times, angles),
            "surface_angle_last": view.last_of("deg", part.times, angles),
            "surface_height_axis": view.last_of("d", part.times, _at(part.heights, 0)),
            "surface_height_wall": view.last_of("d", part.times, _at(part.heights, -1))}


def _at(heights, place):
    """Heights (T,) at one of the places; not a number in a silo too narrow for any."""
    return heights[:, place] if heights.shape[1] else np.full(len(heights), np.nan)
