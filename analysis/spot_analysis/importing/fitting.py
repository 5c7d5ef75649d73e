# SPDX-License-Identifier: GPL-2.0-or-later
"""Walls fitted to a packing that was at rest in them.

A wall lies half a diameter beyond the outermost centres of a layer of grains. A few grains farther out are strays, which
the caller names; where there are hardly any grains at it, there is no such wall.
"""

import numpy as np
from scipy.spatial import ConvexHull

from ..base.errors import AnalysisError
from . import walls

LAYER = 0.02  # d: centres of grains at a wall are this close together, across it, at its outermost
AT_WALL = 0.1  # d from the outermost: grains that touch the wall
STRAYS = 0.01  # grains per d^2 of wall that may lie beyond it
FEWEST = 0.3  # grains per d^2 that a wall has at it, in each third of its height; those of the packings in examples have 0.43 to 1
THIRDS = 3
DIGITS = 4  # of places of walls (d)
CONE = (0.05, 0.999)  # normals along r of what may be a cone: no floor, no cylinder


def fit(shape, positions, diameter, outlet):
    """The Walls of ``shape``, box, cylinder or cone-and-cylinder, and (name, grains per d^2 at it) of each wall.

    positions : (n, 3); outlet : height of the base, None for half a diameter below the lowest grain

    Raises AnalysisError where the packing does not fit.
    """
    scaled = positions / diameter
    base = scaled[:, 2].min() - 0.5 if outlet is None else outlet / diameter
    fitted, coverage = {"box": _box, "cylinder": _cylinder, "cone-and-cylinder": _cone_and_cylinder}[shape](scaled, base)
    poor = min(coverage, key=lambda one: one[1])
    if poor[1] < FEWEST:
        raise AnalysisError(f"--fit {shape}: {poor[0]} has {poor[1]:.2f} grains at it for each d^2, where a wall has more than {FEWEST}: "
                            "no such silo, or a packing of another shape; name the walls by --box, --cylinder, --cone or --walls")
    return _scaled(fitted, diameter), coverage


def _scaled(numbers, diameter):
    make = {4: walls.box, 3: walls.cylinder, 6: walls.cone_and_cylinder}[len(numbers)]
    return make(*(round(float(number), DIGITS) * diameter for number in numbers))


def _outermost(distances, heights, low, high, width):
    """Where the outermost layer of centres ends, and the grains per d^2 at it in that third of it which has fewest.

    distances : (n,) outwards; heights : (n,); low, high : between these the wall is, width : of it
    """
    area = width * (high - low)
    ordered = np.sort(distances)[::-1]
    robust = ordered[min(len(ordered) - 1, int(STRAYS * area))]
    end = ordered[ordered <= robust + LAYER][0]
    at = heights[abs(distances - end) < AT_WALL]
    return end, np.histogram(at, THIRDS, (low, high))[0].min() * THIRDS / max(area, 1e-300)


def _top(positions):
    """Of the bed, without what is heaped on it."""
    return np.quantile(positions[:, 2], 0.98)


def _box(positions, base):
    x, y, z = positions.T
    width = [np.ptp(np.quantile(values, (0.005, 0.995))) for values in (x, y)]
    found = [_outermost(sign * values, z, base, _top(positions), width[1 - axis]) for axis, values in ((0, x), (1, y)) for sign in (-1, 1)]
    numbers = [sign * (found[k][0] + 0.5) for k, sign in enumerate((-1, 1, -1, 1))]
    return numbers, [(f"the wall at the {side} {axis}", found[k][1]) for k, (axis, side) in
                     enumerate((axis, side) for axis in "xy" for side in ("lower", "upper"))]


def _axis_and_radius(positions):
    """x, y, and radius of the outermost centres: a circle through the outermost of each sector, without those far inside."""
    x, y, z = positions.T
    centre = [(np.quantile(values, 0.001) + np.quantile(values, 0.999)) / 2 for values in (x, y)]
    for _ in range(20):
        dx, dy = x - centre[0], y - centre[1]
        r = np.hypot(dx, dy)
        bins = np.floor(z / 2).astype(int) * 64 + np.floor((np.arctan2(dy, dx) / (2 * np.pi) + 0.5) * 36).astype(int)
        order = np.lexsort((-r, bins))
        outer = order[np.unique(bins[order], return_index=True)[1]]
        outer = outer[r[outer] > np.median(r[outer]) - 0.3]
        # x^2 + y^2 = 2 a x + 2 b y + c (Kasa's circle)
        system = np.column_stack([2 * x[outer], 2 * y[outer], np.ones(len(outer))])
        solution = np.linalg.lstsq(system, x[outer]**2 + y[outer]**2, rcond=None)[0]
        if np.hypot(*(solution[:2] - centre)) < 1e-6:
            break
        centre = list(solution[:2])
    return (*centre, np.hypot(x - centre[0], y - centre[1]))


def _cylinder(positions, base):
    x, y, r = _axis_and_radius(positions)
    end, coverage = _outermost(r, positions[:, 2], base, _top(positions), 2 * np.pi * np.quantile(r, 0.995))
    return (x, y, end + 0.5), [("the cylinder", coverage)]


def _cone_and_cylinder(positions, base):
    """The cylinder from the upper half of the bed, the cone from the lower hull of (r, z) about its axis."""
    z, top = positions[:, 2], _top(positions)
    middle = base + 0.6 * (top - base)
    upper = (z > middle) & (z < top)
    x, y, r = _axis_and_radius(positions[upper])
    ring, ring_coverage = _outermost(r, z[upper], middle, top, 2 * np.pi * np.quantile(r, 0.995))
    r = np.hypot(positions[:, 0] - x, positions[:, 1] - y)
    normal, end = _lower_hull(r, z, ring, base)
    for _ in range(5):  # from the hull's edge to the line through all that are at the cone
        near = (abs(r * normal[0] + z * normal[1] - end) < AT_WALL) & (r < ring - 0.5) & (z > base)
        if near.sum() < 10:
            break
        slope = np.polyfit(z[near], r[near], 1)[0]
        normal = np.array([1, -slope]) / np.hypot(1, slope)
        end = np.quantile(r[near] * normal[0] + z[near] * normal[1], 0.9)
    if not CONE[0] < normal[0] < CONE[1]:
        raise AnalysisError("--fit cone-and-cylinder: below the cylinder the packing gets no narrower; try --fit cylinder")
    radius_at = lambda height, wall: (wall - height * normal[1]) / normal[0]
    shoulder = (end + 0.5 - (ring + 0.5) * normal[0]) / normal[1]
    below = (z > base) & (z < shoulder - 1)
    if not below.any():
        raise AnalysisError("--fit cone-and-cylinder: below the cylinder the packing gets no narrower; try --fit cylinder")
    width = np.pi * (max(radius_at(base, end), 0) + ring) / normal[0]  # on average, for each length along z
    end, coverage = _outermost((r * normal[0] + z * normal[1])[below], z[below], base, shoulder, width)
    shoulder = (end + 0.5 - (ring + 0.5) * normal[0]) / normal[1]
    return (x, y, radius_at(base, end + 0.5), ring + 0.5, base, shoulder), [("the cone", coverage), ("the cylinder", ring_coverage)]


def _lower_hull(r, z, ring, base):
    """Outward normal (2,) along r and z, and distance, of the hull's edge with most grains at it that may be a cone."""
    points = np.column_stack([r, z])[(r < ring + LAYER) & (z > base)]
    best = (0, None)
    for normal_r, normal_z, offset in ConvexHull(points).equations:
        if CONE[0] < normal_r < CONE[1] and normal_z < 0:
            at = np.count_nonzero(abs(points @ (normal_r, normal_z) + offset) < AT_WALL)
            best = max(best, (at, (normal_r, normal_z, -offset)), key=lambda one: one[0])
    if best[1] is None:
        raise AnalysisError("--fit cone-and-cylinder: below the cylinder the packing gets no narrower; try --fit cylinder")
    return np.array(best[1][:2]), best[1][2]
