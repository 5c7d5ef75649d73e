#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Write the walls of the hopper, a cone under an upright cylinder, as an ASCII STL mesh. Lengths are in metres.

Both are prisms around the circles, touching them in the middle of each side, so that no grain that is inside the round walls
overlaps the mesh.
"""

import argparse
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from stl import write_stl  # noqa: E402  (beside this folder)


def wall_triangles(profile, sides=96):
    """Triangles (three (x, y, z) corners) of a surface of revolution, whose profile is a list of (radius, height)."""
    outside = 1 / math.cos(math.pi / sides)
    corners = [(outside * math.cos(2 * math.pi * k / sides), outside * math.sin(2 * math.pi * k / sides)) for k in range(sides)]
    triangles = []
    for (low_radius, low), (high_radius, high) in zip(profile, profile[1:]):
        for (x, y), (next_x, next_y) in zip(corners, corners[1:] + corners[:1]):
            a, b = (low_radius * x, low_radius * y, low), (low_radius * next_x, low_radius * next_y, low)
            c, d = (high_radius * next_x, high_radius * next_y, high), (high_radius * x, high_radius * y, high)
            triangles += [(a, b, c), (a, c, d)]
    return triangles


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("rim", type=float, help="radius of the outlet, at z = 0 (m)")
    parser.add_argument("side", type=float, help="radius of the cylinder (m)")
    parser.add_argument("shoulder", type=float, help="height at which the cone ends (m)")
    parser.add_argument("top", type=float, help="height of the cylinder's end (m)")
    parser.add_argument("stl", help="file to write")
    args = parser.parse_args()
    try:
        if not 0 < args.rim < args.side or not 0 < args.shoulder < args.top:
            raise ValueError("radii and heights must be positive and increase")
        write_stl(args.stl, "walls", wall_triangles([(args.rim, 0.0), (args.side, args.shoulder), (args.side, args.top)]))
    except (ValueError, OSError) as error:
        sys.exit(f"ERROR: {error}")


if __name__ == "__main__":
    main()
