# SPDX-License-Identifier: GPL-2.0-or-later
"""Share of crystal-like grains, by the bond order parameters of ten Wolde, Ruiz-Montero, Frenkel (1996).

q_6m(i) is the mean of the spherical harmonics Y_6m over the bonds of grain i, made a unit vector over m. Two bonded
grains are connected if the scalar product of theirs exceeds 0.7, and a grain with at least 7 connections counts as
crystal-like, whatever the lattice: FCC and HCP score alike.
"""

import math

import numpy as np

NAME = "bond_order"
CONNECTED = 0.7
CONNECTIONS = 7
MEANING = {"crystal_share": "7 or more bonds with q6.q6 > 0.7"}
NEEDS = {"*": ("structure",)}


def harmonics(directions):
    """Y_6m for m = 0..6 of unit vectors (b, 3); returns (b, 7) complex. Those of -m follow by symmetry."""
    x, y, z = directions.T
    w, s = x + 1j * y, z * z
    return np.stack([
        math.sqrt(13 / math.pi) / 32 * (((231 * s - 315) * s + 105) * s - 5),
        -math.sqrt(273 / (2 * math.pi)) / 16 * w * z * ((33 * s - 30) * s + 5),
        math.sqrt(1365 / math.pi) / 64 * w**2 * ((33 * s - 18) * s + 1),
        -math.sqrt(1365 / math.pi) / 32 * w**3 * z * (11 * s - 3),
        3 * math.sqrt(91 / (2 * math.pi)) / 32 * w**4 * (11 * s - 1),
        -3 * math.sqrt(1001 / math.pi) / 32 * w**5 * z,
        math.sqrt(3003 / math.pi) / 64 * w**6,
    ], axis=1)


def order_vectors(bonds):
    """Unit vectors (n, 13) whose scalar products are those of q_6m over m = -6..6; zero for a grain without bonds."""
    values = harmonics(bonds.directions)
    # Y_6m(-r) = Y_6m(r), so a bond gives both its grains the same
    columns = np.hstack([values[:, :1].real, math.sqrt(2) * values[:, 1:].real, math.sqrt(2) * values[:, 1:].imag])
    total = np.stack([np.bincount(bonds.first, column, len(bonds.inside))
                      + np.bincount(bonds.second, column, len(bonds.inside)) for column in columns.T], axis=1)
    length = np.sqrt((total**2).sum(axis=1, keepdims=True))
    return total / np.where(length > 0, length, 1)


def crystal_share(bonds):
    """Share of the region's grains that are crystal-like; not a number without grains."""
    vectors = order_vectors(bonds)
    connected = (vectors[bonds.first] * vectors[bonds.second]).sum(axis=1) > CONNECTED
    connections = (np.bincount(bonds.first[connected], minlength=len(bonds.inside))
                   + np.bincount(bonds.second[connected], minlength=len(bonds.inside)))
    crystal = connections[bonds.inside] >= CONNECTIONS
    return float(crystal.mean()) if crystal.size else math.nan


class Measurement:
    """share : (T,) in the structure region, not a number where it is not full; times : (T,)"""

    def __init__(self, container, region):
        self._times, self._shares = [], []

    def add(self, snapshot, history):
        self._times.append(snapshot.time)
        self._shares.append(crystal_share(snapshot.bonds) if snapshot.is_covered else math.nan)

    def arrays(self):
        return {"times": np.array(self._times), "share": np.array(self._shares)}


def quantities(view):
    part = view.run.measured[NAME]
    return {"crystal_share": view.mean_of("1", part.times, part.share)}
