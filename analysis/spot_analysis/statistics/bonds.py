# SPDX-License-Identifier: GPL-2.0-or-later
"""Bonds: pairs of grains closer than the first minimum of g(r); lengths in d."""

from dataclasses import dataclass

import numpy as np

from ..reading.container import nearest_image
from .neighbours import close_pairs

BOND_CUTOFF = 1.38  # d; first minimum of g(r) in 2006, and ours within the width of that minimum


@dataclass(frozen=True)
class Bonds:
    """Bonds of a region's grains and of their neighbours.

    grains : (n,) indices, into the packing, of the grains within two bonds of the region
    inside : (n,) which of them are in the region; their bonds, and those of their neighbours, are all here
    first, second : (b,) indices into ``grains``, each bond once
    directions : (b, 3) unit vectors from first to second
    """

    grains: np.ndarray
    inside: np.ndarray
    first: np.ndarray
    second: np.ndarray
    directions: np.ndarray


def find_bonds(positions, region, cutoff=BOND_CUTOFF, period=None):
    """Bonds of the packing ``positions`` (n, 3) in and around ``region``; period : of y, None where nothing repeats."""
    grains = np.flatnonzero(region.contains(positions, margin=2 * cutoff))
    near = positions[grains]
    first, second = close_pairs(near, cutoff, period)
    separation = nearest_image(near[second] - near[first], period)
    length = np.sqrt((separation**2).sum(axis=1))
    return Bonds(grains, region.contains(near), first, second, separation / length[:, None])


def directions_by_grain(bonds):
    """Unit vectors to the neighbours of each grain inside the region, (m, k, 3); rows are filled up with zeros."""
    grain = np.concatenate([bonds.first, bonds.second])
    direction = np.concatenate([bonds.directions, -bonds.directions])
    kept = bonds.inside[grain]
    order = np.argsort(grain[kept], kind="stable")
    grain, direction = grain[kept][order], direction[kept][order]
    degree = np.bincount(grain, minlength=len(bonds.inside))
    rank = np.arange(len(grain)) - (np.cumsum(degree) - degree)[grain]
    row = np.cumsum(bonds.inside) - 1
    table = np.zeros((int(bonds.inside.sum()), int(degree.max(initial=0)), 3))
    table[row[grain], rank] = direction
    return table
