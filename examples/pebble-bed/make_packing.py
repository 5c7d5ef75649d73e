#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Puts a bed for the whole reactor together from copies of a poured one, side by side and one above the other.

    make_packing.py ANGLE FILE.data.gz

440,000 pebbles in a cylinder 58 d wide, over a funnel of this half-angle (degrees) to an outlet of 8 d, as large as
glass beads, as the packings of ../hoppers are. The poured bed is the silo's that is periodic in y, so copies fit together
there. Elsewhere a wall was between them, and at the round wall they are cut: there the bed is loose until it flows.
"""
import argparse
import gzip
import math
from pathlib import Path

import numpy as np

DIAMETER = 0.003            # m
PEBBLES = 440_000
OUTLET, RADIUS = 4.0, 29.0  # d
COPY = np.array([32.0, 16.0, 67.0])  # d: width and depth of the silo, and up to where its packing is taken
COPIES = (2, 4, 3)


def poured():
    """Places in d, the silo's corner being the origin, up to the top of a copy. Shape (n, 3)."""
    path = Path(__file__).resolve().parent.parent / "silo" / "periodic-depth" / "packing.data.gz"
    with gzip.open(path, "rt") as lines:
        for line in lines:
            if line.startswith("Atoms"):
                break
        places = np.loadtxt(lines, usecols=(4, 5, 6)) / DIAMETER
    places[:, :2] += 0.5 * COPY[:2]
    return places[places[:, 2] < COPY[2] - 0.5]


def bed(angle):
    """Places in d, the outlet's middle being the origin. Shape (PEBBLES, 3)."""
    copy = poured()
    low = np.array([-0.5 * COPY[0] * COPIES[0], -0.5 * COPY[1] * COPIES[1], 0.0])
    blocks = []
    for i, j, k in np.ndindex(*COPIES):
        block = copy.copy()
        if (i + k) % 2:  # so that copies beside each other differ
            block[:, 0] = COPY[0] - block[:, 0]
        blocks.append(block + low + COPY * (i, j, k))
    places = np.concatenate(blocks)
    r, z = np.hypot(places[:, 0], places[:, 1]), places[:, 2]
    slope = math.radians(angle)
    to_funnel = (OUTLET - r) * math.cos(slope) + z * math.sin(slope)
    places = places[(r < RADIUS - 0.5) & (to_funnel > 0.5)]
    if len(places) < PEBBLES:
        raise SystemExit(f"make_packing.py: copies hold {len(places)} pebbles but must hold {PEBBLES}")
    return places[np.argsort(places[:, 2])][:PEBBLES]


def write(places, path):
    top = places[:, 2].max() + 15.0
    box = [(-RADIUS - 0.5, RADIUS + 0.5)] * 2 + [(-11.0, top)]
    with gzip.open(path, "wt", compresslevel=6) as out:
        out.write(f"{len(places)} pebbles, put together\n\n{len(places)} atoms\n1 atom types\n\n")
        for axis, (low, high) in zip("xyz", box):
            out.write(f"{low * DIAMETER:.6g} {high * DIAMETER:.6g} {axis}lo {axis}hi\n")
        out.write("\nAtoms # sphere\n\n")
        for identity, (x, y, z) in enumerate(places * DIAMETER, 1):
            out.write(f"{identity} 1 {DIAMETER} 2500 {x:.10g} {y:.10g} {z:.10g}\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("angle", type=float)
    parser.add_argument("file")
    options = parser.parse_args()
    if not 5.0 <= options.angle <= 85.0:
        parser.error(f"angle is {options.angle:g} but must be from 5 to 85 degrees")
    write(bed(options.angle), options.file)


if __name__ == "__main__":
    main()
