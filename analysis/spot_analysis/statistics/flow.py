# SPDX-License-Identifier: GPL-2.0-or-later
"""Flow of grains between snapshots: counts above planes and profiles of the vertical velocity; units d, tau."""

import numpy as np

SLICE_HALF_THICKNESS = 1.0


def count_above(heights, levels):
    """Number of grains with z > level; heights (n,), levels (l,) ascending; returns (l,) int64.

    Grains leave through the base only, so the decrease of this count is the flux through the level.
    """
    return len(heights) - np.searchsorted(np.sort(heights), levels, side="right")


def common_grains(ids, later_ids):
    """Indices into both of the grains that are in both; ids are ascending and unique."""
    _, first, second = np.intersect1d(ids, later_ids, assume_unique=True, return_indices=True)
    return first, second


def velocity_profile(start, end, duration, heights, edges):
    """Sums for the profile of downward velocity across x at some heights.

    start, end : (n, 3) positions of the same grains, ``duration`` tau apart
    heights : (h,) middles of slices 2 d thick
    edges : (k + 1,) bins in x

    A grain belongs to the slice and bin that holds the middle of its displacement.
    Returns counts (h, k) int64 and sums of -v_z (h, k), d/tau.
    """
    middle = (start + end) / 2
    speed = (start - end)[:, 2] / duration
    counts, sums = [], []
    for height in heights:
        inside = np.abs(middle[:, 2] - height) < SLICE_HALF_THICKNESS
        x = middle[inside, 0]
        counts.append(np.histogram(x, edges)[0])
        sums.append(np.histogram(x, edges, weights=speed[inside])[0])
    return np.array(counts), np.array(sums)
