#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Turns the packing of two sizes that liggghts-inputs/silo/in.pour writes into the one that is drained here: atoms of type 1 are
the small ones, those of type 2 the large ones, and coordinates have nine digits.

    make_packing.py packed.data packing-1.5.data.gz
"""
import gzip
import sys

import numpy as np

# Walls, in m; room for what falls through the base, at z = 0.
BOX = (("x", -0.03, 0.03), ("y", -0.012, 0.012), ("z", -0.03, 0.18))


def main(poured, data):
    with open(poured, encoding="ascii") as lines:
        for line in lines:
            if line.startswith("Atoms"):
                break
        else:
            sys.exit(f"make_packing.py: {poured}: no section 'Atoms'")
        rows = []
        for line in lines:  # id, type, diameter, density, x, y, z, up to the next section
            words = line.split()
            if words and words[0][0].isalpha():
                break
            if words:
                rows.append([float(word) for word in words[:7]])
    table = np.array(rows)
    diameter = table[:, 2]
    split = (diameter.min() + diameter.max()) / 2
    out = [f"Two sizes of glass beads at rest, see README.md\n\n{len(rows)} atoms\n2 atom types\n\n"]
    out += [f"{low} {high} {axis}lo {axis}hi\n" for axis, low, high in BOX]
    out += ["\nAtoms # sphere\n\n"]
    for grain, _, wide, density, x, y, z in table[np.argsort(table[:, 0])]:
        out.append(f"{grain:.0f} {1 if wide < split else 2} {wide:.9g} {density:g} {x:.9g} {y:.9g} {z:.9g}\n")
    with open(data, "wb") as raw, gzip.GzipFile("", "wb", 9, raw, mtime=0) as packed:
        packed.write("".join(out).encode())


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: make_packing.py packed.data packing.data.gz")
    main(*sys.argv[1:])
