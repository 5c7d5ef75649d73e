# SPDX-License-Identifier: GPL-2.0-or-later
"""Pairs of grains that are close to each other; lengths in d."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from ..reading.container import nearest_image

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


def region_pairs(positions, region, reach=RDF_RANGE, period=None):
    """Pairs closer than ``reach`` of grains of the region with all grains, the region's or not."""
    near = positions[region.contains(positions, margin=reach)]
    inside = region.contains(near)
    first, second = close_pairs(near, reach, period)
    ends = inside.astype(np.int8)
    ends = ends[first] + ends[second]
    kept = np.flatnonzero(ends)
    return Pairs(distances(near, first[kept], second[kept], period), ends[kept], int(inside.sum()))


def distances(positions, first, second, period=None):
    """Distances of the pairs (p,); by coordinate, which is several times faster than by rows."""
    square = np.zeros(len(first))
    for axis, coordinate in enumerate(np.ascontiguousarray(positions.T)):
        apart = coordinate[first] - coordinate[second]
        if axis == 1 and period is not None:
            apart -= period * np.rint(apart / period)
        square += apart**2
    return np.sqrt(square)


def close_pairs(positions, reach, period=None):
    """Indices (first, second) of the pairs closer than ``reach``, at most half of the period of y; period : None where nothing
    repeats."""
    if len(positions) < 2:
        return np.empty(0, dtype=np.int64), np.empty(0, dtype=np.int64)
    if period is None:
        tree = cKDTree(positions)
    else:
        tree = cKDTree(_from_zero(positions, period), boxsize=[0, period, 0])
    pairs = tree.query_pairs(reach, output_type="ndarray")
    return np.ascontiguousarray(pairs[:, 0]), np.ascontiguousarray(pairs[:, 1])


def _from_zero(positions, period):
    """Positions with 0 <= y < period."""
    wrapped = nearest_image(positions, period)
    y = wrapped[:, 1]
    y[y < 0] += period
    y[y >= period] = 0  # rounding
    return wrapped


def largest_overlap(positions, period=None):
    """Largest overlap of any two grains, d."""
    first, second = close_pairs(positions, 1.0, period)
    if first.size == 0:
        return 0.0
    return float(1 - distances(positions, first, second, period).min())
