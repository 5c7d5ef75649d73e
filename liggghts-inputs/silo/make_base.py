#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Write the base of the silo, a plate at z = 0 with an orifice at its centre, as an ASCII STL mesh.

Lengths are in metres. The plate fills |x| <= half_width, |y| <= half_depth. Each side of a round orifice's polygon is joined to
the wall that lies behind it as seen from the centre, by two triangles. Where the rim comes closer to a wall than `sliver`, that
piece is left out: triangles there would be so thin that LIGGGHTS rejects them, and a grain whose centre is half a diameter
from the wall would not rest on them. A slot goes from y = -half_depth to half_depth, 2 radius wide.

Several orifices lie in the middles of equal parts along x. One that is closed has a lid, whose corners are those of the rim:
parts meet in common edges, since LIGGGHTS would count a contact twice where they don't.
"""

import argparse
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from stl import write_stl  # noqa: E402  (beside this folder)


def rim_angles(half_width, half_depth, sides):
    """Angles of the rim's vertices: evenly spread, with those of the plate's four corners among them."""
    corner = math.atan2(half_depth, half_width)
    # One quadrant in two sectors, each divided evenly, so that the mesh has the silo's two mirror planes.
    below = max(1, round(sides / 4 * corner / (math.pi / 2)))
    above = max(1, round(sides / 4) - below)
    quadrant = [corner * i / below for i in range(below)]
    quadrant += [corner + (math.pi / 2 - corner) * i / above for i in range(above)]
    quadrant.append(math.pi / 2)
    half = quadrant + [math.pi - a for a in reversed(quadrant[:-1])]
    return half + [-a for a in reversed(half[1:-1])]


def base_triangles(half_width, half_depth, radius, sliver, sides=96):
    """Triangles (three (x, y) corners, anticlockwise) of the plate around the orifice."""
    if min(half_width, half_depth, radius) <= 0 or sliver < 0:
        raise ValueError("half width, half depth and radius must be positive, sliver must not be negative")
    for wall, name in ((half_width, "half width"), (half_depth, "half depth")):
        if radius > wall * (1 + 1e-9):
            raise ValueError(f"orifice of radius {radius:g} m does not fit the base: its {name} is {wall:g} m")

    angles = rim_angles(half_width, half_depth, sides)
    rays = []
    for angle in angles:
        x, y = math.cos(angle), math.sin(angle)
        # A ray along an axis never meets the walls parallel to it.
        reach = min(half_width / abs(x) if abs(x) > 1e-12 else math.inf,
                    half_depth / abs(y) if abs(y) > 1e-12 else math.inf)
        gap = min(half_width - radius * abs(x), half_depth - radius * abs(y))
        rays.append(((radius * x, radius * y), (reach * x, reach * y), gap))

    triangles = []
    for (rim, wall, gap), (next_rim, next_wall, next_gap) in zip(rays, rays[1:] + rays[:1]):
        if min(gap, next_gap) <= sliver:
            continue
        triangles.append((rim, wall, next_wall))
        triangles.append((rim, next_wall, next_rim))
    if not triangles:
        raise ValueError(f"orifice of radius {radius:g} m leaves nothing of the base but slivers under {sliver:g} m")
    return triangles


def slot_triangles(half_width, half_depth, radius):
    """Of the plates on both sides of a slot."""
    if not 0 < radius < half_width or half_depth <= 0:
        raise ValueError(f"slot {2 * radius:g} m wide does not fit the base: its half width is {half_width:g} m")
    return rectangle(-half_width, -radius, half_depth) + rectangle(radius, half_width, half_depth)


def rectangle(low, high, half_depth):
    corners = [(low, -half_depth), (high, -half_depth), (high, half_depth), (low, half_depth)]
    return polygon(corners)


def polygon(corners):
    """Triangles of a convex polygon, back and forth between its sides, so that no corner belongs to more than three."""
    triangles, low, high = [], 0, len(corners) - 1
    while low + 1 < high:
        triangles.append((corners[low], corners[low + 1], corners[high]))
        low += 1
        if low + 1 < high:
            triangles.append((corners[low], corners[high - 1], corners[high]))
            high -= 1
    return triangles


def lid_triangles(half_width, half_depth, radius, slot, sides=96):
    """Of what closes an orifice."""
    if slot:
        return rectangle(-radius, radius, half_depth)
    return polygon([(radius * math.cos(a), radius * math.sin(a)) for a in rim_angles(half_width, half_depth, sides)])


def base_of_parts(args):
    """Triangles of the base with all its orifices."""
    if args.holes < 1 or not 0 <= args.open <= args.holes:
        raise ValueError(f"holes ({args.holes}) must be 1 or more, and open ({args.open}) one of them, or 0 for all")
    part = args.half_width / args.holes
    plate = (slot_triangles(part, args.half_depth, args.radius) if args.slot else
             base_triangles(part, args.half_depth, args.radius, args.sliver))
    lid = lid_triangles(part, args.half_depth, args.radius, args.slot)
    triangles = []
    for hole in range(1, args.holes + 1):
        centre = (2 * hole - 1 - args.holes) * part
        here = plate if args.open in (0, hole) else plate + lid
        triangles += [[(x + centre, y) for x, y in corners] for corners in here]
    return triangles


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("half_width", type=float, help="half width of the base along x (m)")
    parser.add_argument("half_depth", type=float, help="half depth of the base along y (m)")
    parser.add_argument("radius", type=float, help="radius of the orifice (m)")
    parser.add_argument("sliver", type=float, help="leave out the plate where the rim is closer to a wall than this (m)")
    parser.add_argument("stl", help="file to write")
    parser.add_argument("--slot", type=int, choices=(0, 1), default=0,
                        help="1: slots from front to back, 2 radius wide, in the place of round orifices")
    parser.add_argument("--holes", type=int, default=1, help="number of orifices (default: %(default)s)")
    parser.add_argument("--open", type=int, default=0, help="the only one that is open, counted along x from 1; 0: all are (default)")
    args = parser.parse_args()
    try:
        flat = base_of_parts(args)
        write_stl(args.stl, "base", [[(x, y, 0.0) for x, y in corners] for corners in flat], "0 0 1")
    except (ValueError, OSError) as error:
        sys.exit(f"ERROR: {error}")


if __name__ == "__main__":
    main()
