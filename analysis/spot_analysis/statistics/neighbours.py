# SPDX-License-Identifier: GPL-2.0-or-later
"""Pairs of grains that are close to each other; lengths in d."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

RDF_RANGE = 5.0


@dataclass(frozen=True)
class Pairs:
    """Pairs that have a grain in a region.

    distance : (p,) d
    ends : (p,) 1 or 2, how many of the two grains are in the region
    grains : number of grains in the region
    """

    distance: np.ndarray
    ends: np.ndarray
    grains: int


def region_pairs(positions, region, reach=RDF_RANGE):
    """Pairs closer than ``reach`` of grains of the region with all grains, the region's or not."""
    near = positions[region.contains(positions, margin=reach)]
    inside = region.contains(near)
    first, second = close_pairs(near, reach)
    ends = inside.astype(np.int8)
    ends = ends[first] + ends[second]
    kept = np.flatnonzero(ends)
    return Pairs(_distances(near, first[kept], second[kept]), ends[kept], int(inside.sum()))


def _distances(positions, first, second):
    """Distances of the pairs (p,); by coordinate, which is several times faster than by rows."""
    square = np.zeros(len(first))
    for coordinate in np.ascontiguousarray(positions.T):
        square += (coordinate[first] - coordinate[second])**2
    return np.sqrt(square)


def close_pairs(positions, reach):
    """Indices (first, second) of the pairs closer than ``reach``."""
    if len(positions) < 2:
        return np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64)
    pairs = cKDTree(positions).query_pairs(reach, output_type="ndarray")
    return np.ascontiguousarray(pairs[:, 0]), np.ascontiguousarray(pairs[:, 1])


def largest_overlap(positions):
    """Largest overlap of any two grains, d."""
    first, second = close_pairs(positions, 1.0)
    if first.size == 0:
        return 0.0
    return float(1 - _distances(positions, first, second).min())
