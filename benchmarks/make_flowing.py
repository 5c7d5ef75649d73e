#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Turns two successive dumps of the DEM reference, in d and tau, into flowing.data.gz, a LAMMPS data file in SI units.

    make_flowing.py drain.400000.dump.gz drain.420000.dump.gz 2.0 flowing.data.gz

Positions are those of the second dump; velocities are displacements over the given time (tau) between the two.
"""

import gzip
import math
import sys
from decimal import Decimal

DIAMETER, DENSITY = Decimal("0.003"), 2500  # m, kg/m3
SPEED = 0.003 / math.sqrt(0.003 / 9.81)  # one d/tau, m/s
BOX = (("x", -25, 25), ("y", -4, 4), ("z", -11, 180))
LOWEST = -9  # d; grains on their way out


def read_dump(path):
    """id -> (x, y, z) as strings"""
    with gzip.open(path, "rt") as lines:
        for line in lines:
            if line.startswith("ITEM: ATOMS"):
                if line.split()[2:] != ["id", "x", "y", "z"]:
                    sys.exit(f"make_flowing.py: {path}: columns must be id x y z, not {line[12:].strip()}")
                return {int(row[0]): row[1:] for row in map(str.split, lines)}
    sys.exit(f"make_flowing.py: {path}: no 'ITEM: ATOMS' line")


def plain(number):
    return format(number.normalize(), "f")


def main(earlier, later, tau_between, data):
    before, now = read_dump(earlier), read_dump(later)
    now = {identity: place for identity, place in sorted(now.items()) if float(place[2]) > LOWEST}
    out = [f"Glass beads in steady flow, see README.md\n\n{len(now)} atoms\n1 atom types\n\n"]
    out += [f"{plain(low * DIAMETER)} {plain(high * DIAMETER)} {axis}lo {axis}hi\n" for axis, low, high in BOX]
    out += ["\nAtoms # sphere\n\n"]
    for identity, place in now.items():
        out.append(f"{identity} 1 {DIAMETER} {DENSITY} {' '.join(plain(Decimal(c) * DIAMETER) for c in place)}\n")
    out += ["\nVelocities\n\n"]
    for identity, place in now.items():
        velocity = (SPEED * (float(b) - float(a)) / float(tau_between) for a, b in zip(before[identity], place))
        out.append(f"{identity} {' '.join(f'{v:.2f}' for v in velocity)} 0 0 0\n")
    with open(data, "wb") as raw, gzip.GzipFile("", "wb", 9, raw, mtime=0) as packed:
        packed.write("".join(out).encode())


if __name__ == "__main__":
    if len(sys.argv) != 5:
        sys.exit("usage: make_flowing.py EARLIER.dump.gz LATER.dump.gz TAU_BETWEEN flowing.data.gz")
    main(*sys.argv[1:])
