#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Turns what liggghts-inputs/silo/in.pour writes for two sizes into a data file for LAMMPS: type 1 small, type 2 large.

    make_packing.py packed.dump packing-1.5.data.gz
"""
import gzip
import sys

import numpy as np

DENSITY = 2500  # kg/m3, glass
# Walls, in m; room for what falls through the base, at z = 0.
BOX = (("x", -0.03, 0.03), ("y", -0.012, 0.012), ("z", -0.03, 0.18))


def main(dump, data):
    with open(dump, encoding="ascii") as lines:
        for line in lines:
            if line.startswith("ITEM: ATOMS"):
                break
        else:
            sys.exit(f"make_packing.py: {dump}: no 'ITEM: ATOMS' line")
        columns = line.split()[2:]
        rows = np.array([row.split() for row in lines], dtype=float)
    if set("id x y z radius".split()) - set(columns):
        sys.exit(f"make_packing.py: {dump}: columns must have id x y z radius, not {' '.join(columns)}")
    table = dict(zip(columns, rows.T))
    split = (table["radius"].min() + table["radius"].max()) / 2
    out = [f"Two sizes of glass beads at rest, see README.md\n\n{len(rows)} atoms\n2 atom types\n\n"]
    out += [f"{low} {high} {axis}lo {axis}hi\n" for axis, low, high in BOX]
    out += ["\nAtoms # sphere\n\n"]
    for k in np.argsort(table["id"]):
        kind = 1 if table["radius"][k] < split else 2
        out.append(f"{table['id'][k]:.0f} {kind} {2 * table['radius'][k]:.9g} {DENSITY} "
                   f"{table['x'][k]:.9g} {table['y'][k]:.9g} {table['z'][k]:.9g}\n")
    with open(data, "wb") as raw, gzip.GzipFile("", "wb", 9, raw, mtime=0) as packed:
        packed.write("".join(out).encode())


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: make_packing.py packed.dump packing.data.gz")
    main(*sys.argv[1:])
