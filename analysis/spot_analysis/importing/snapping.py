# SPDX-License-Identifier: GPL-2.0-or-later
"""Fitted walls moved to where the outlet says that they are: a hopper's scene wants axis, floor and rim to be exactly there."""

from .walls import box, cone_and_cylinder, cylinder

NEAR = 0.02  # d; a fit finds walls as well as this


def middle_of(walls):
    """x, y of the axis, or of the middle between the planes."""
    x_low, x_high, y_low, y_high = walls.numbers if walls.axis is None else [0] * 4
    return walls.axis or ((x_low + x_high) / 2, (y_low + y_high) / 2)


def near(value, wanted, diameter):
    """``wanted`` where ``value`` is within NEAR d of it, else ``value``; lengths in one unit."""
    return wanted if abs(value - wanted) <= NEAR * diameter else value


def snapped(walls, orifice, diameter):
    """Walls whose middle is that of the outlet, whose cone begins at its height and as wide as it, where a fit can't tell otherwise.

    orifice : (x, y, z, R); diameter : in its unit
    """
    x, y = (near(value, wanted, diameter) for value, wanted in zip(middle_of(walls), orifice))
    if walls.name == "cylinder":
        return cylinder(x, y, walls.numbers[2])
    if walls.name == "cone":
        low, radius, base, shoulder = walls.numbers[2:]
        along_r = diameter / walls.lines[0][0]  # what a cone's distance being wrong by d does to its radius
        return cone_and_cylinder(x, y, near(low, orifice[3], along_r), radius, near(base, orifice[2], diameter), shoulder)
    halves = [(high - low) / 2 for low, high in (walls.numbers[:2], walls.numbers[2:])]
    return box(x - halves[0], x + halves[0], y - halves[1], y + halves[1])
