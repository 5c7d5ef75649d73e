# SPDX-License-Identifier: GPL-2.0-or-later
"""Whether an outlet is where the walls and the packing let one be."""

import numpy as np

from ..base.errors import AnalysisError
from .snapping import NEAR

RING = 0.5  # d of floor around the outlet at the lower end of a cone
ABOVE = 2.0  # d between the outlet's height and the lowest grain


def require_inside(walls, orifice, diameter):
    """Raises AnalysisError where the outlet (x, y, z, R) reaches beyond a wall of Walls at its height."""
    x, y, z, radius = orifice
    gaps = [plane[3] - x * plane[0] - y * plane[1] - radius for plane in walls.planes]
    gaps += [edge - np.hypot(x - walls.axis[0], y - walls.axis[1]) - radius for edge in _radii(walls, z)]
    nearest = int(np.argmin(gaps))
    if gaps[nearest] < -NEAR * diameter:
        at = f", whose radius is {_radii(walls, z)[nearest]:.6g} at its height" if walls.axis else ""
        place = " ".join(f"{value + 0.0:.6g}" for value in orifice)
        raise AnalysisError(f"--orifice {place} (x y z R): reaches {-gaps[nearest] / diameter:.2f} d beyond "
                            f"{walls.parts[nearest]}{at}")


def doubts(walls, orifice, lowest, diameter):
    """Lines on what may be meant otherwise. lowest : height of the lower end of the lowest grain"""
    found = []
    ring = _radii(walls, orifice[2])[0] - orifice[3] if walls.name == "cone" else 0
    if ring > RING * diameter:
        found.append(f"--orifice: the cone's radius is {ring + orifice[3]:.6g} at the outlet's height, "
                     f"{ring / diameter:.2f} d more than the outlet's; the rest is floor")
    if lowest > orifice[2] + ABOVE * diameter:
        found.append(f"the lowest grain is {(lowest - orifice[2]) / diameter:.1f} d above the outlet: "
                     "is that its height? (--floor auto)")
    return found


def _radii(walls, height):
    """Of the inside at a height, one for each line."""
    return [(line[2] - height * line[1]) / line[0] for line in walls.lines]
