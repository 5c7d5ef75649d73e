# SPDX-License-Identifier: GPL-2.0-or-later
"""Structure of one packing: g(r), packing fraction, contacts and badness; lengths in d."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

RDF_RANGE = 5.0
RDF_EDGES = np.linspace(0, RDF_RANGE, 201)


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


def packing_fraction(grains, region, container):
    """Volume of ``grains`` spheres over the region's volume from wall to wall."""
    return grains * math.pi / 6 / (region.area() * 2 * container.half_depth)


def contacts_per_grain(pairs):
    """Mean number of grains, walls not counted, that overlap a grain of the region."""
    return pairs.ends[pairs.distance < 1].sum() / pairs.grains


def badness(pairs):
    """B = (1/p) sum_i sum_j (delta_ij/d)^2 over the p grains i of the region, all j (2010).

    A pair inside the region is thus counted from both ends.
    """
    overlap = np.maximum(1 - pairs.distance, 0)
    return (pairs.ends * overlap**2).sum() / pairs.grains


def rdf_counts(pairs, edges=RDF_EDGES):
    """Partners of the region's grains in each shell; (len(edges) - 1,) int64, summed over grains. Shells are even."""
    # numpy sorts the pairs when it is given edges or whole-number weights
    counts = np.histogram(pairs.distance, len(edges) - 1, (edges[0], edges[-1]), weights=pairs.ends.astype(float))[0]
    return np.rint(counts).astype(np.int64)


def slab_rdf(counts, grains, frames, region, container, edges=RDF_EDGES):
    """g(r) between two walls.

    counts : (..., k) partners summed over grains and frames
    grains : (...) grains of the region summed over frames
    frames : (...) number of frames

    A grain placed evenly over a slab of thickness T expects 4 pi r^2 rho (1 - r/(2T)) partners per unit r for
    r <= T and 4 pi r^2 rho T/(2r) beyond (2010). T is the range of the centres, walls' distance less d, and rho
    the density over it: taking one from centres and the other from walls is off by d over the walls' distance.
    Grains stand in layers at the walls, not evenly, so g stays a few per cent below 1 for 3 d < r < T.
    """
    thickness = 2 * container.half_depth - 1
    density = np.asarray(grains, dtype=float) / np.asarray(frames, dtype=float) / (region.area() * thickness)
    expected = np.diff(_ideal_partners(np.asarray(edges), thickness))
    return np.asarray(counts) / (np.asarray(grains, dtype=float) * density)[..., None] / expected


def _ideal_partners(r, thickness):
    """Integral from 0 to r of the expected count at unit density."""
    near = np.minimum(r, thickness)
    beyond = math.pi * thickness * (np.maximum(r, thickness)**2 - thickness**2)
    return 4 * math.pi * (near**3 / 3 - near**4 / (8 * thickness)) + beyond
