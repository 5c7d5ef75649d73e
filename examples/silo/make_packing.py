#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Turns a dump of a packing in units of the grain diameter into packing.data.gz, a LAMMPS data file in SI units.

    make_packing.py packed.dump.gz packing.data.gz

Decimal arithmetic: every coordinate is exactly 0.003 times the printed one.
"""
import gzip
import sys
from decimal import Decimal

DIAMETER = Decimal("0.003")  # m
DENSITY = 2500  # kg/m3, glass
# Walls at +-25 d and +-4 d; room for what falls through the base, at z = 0, and for a higher packing.
BOX = (("x", -25, 25), ("y", -4, 4), ("z", -11, 180))


def read_dump(path):
    """Rows (id, x, y, z) as strings, from a LAMMPS text dump with these four columns."""
    with gzip.open(path, "rt") as lines:
        for line in lines:
            if line.startswith("ITEM: ATOMS"):
                if line.split()[2:] != ["id", "x", "y", "z"]:
                    sys.exit(f"make_packing.py: {path}: columns must be id x y z, not {line[12:].strip()}")
                return sorted((line.split() for line in lines), key=lambda row: int(row[0]))
    sys.exit(f"make_packing.py: {path}: no 'ITEM: ATOMS' line")


def plain(number):
    return format(number.normalize(), "f")


def main(dump, data):
    rows = read_dump(dump)
    out = [f"55,000 glass beads at rest, see README.md\n\n{len(rows)} atoms\n1 atom types\n\n"]
    out += [f"{plain(low * DIAMETER)} {plain(high * DIAMETER)} {axis}lo {axis}hi\n" for axis, low, high in BOX]
    out += ["\nAtoms # sphere\n\n"]
    for identity, *position in rows:
        x, y, z = (plain(Decimal(c) * DIAMETER) for c in position)
        out.append(f"{identity} 1 {DIAMETER} {DENSITY} {x} {y} {z}\n")
    with open(data, "wb") as raw, gzip.GzipFile("", "wb", 9, raw, mtime=0) as packed:
        packed.write("".join(out).encode())


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: make_packing.py packed.dump.gz packing.data.gz")
    main(*sys.argv[1:])
