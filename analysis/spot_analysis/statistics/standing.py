# SPDX-License-Identifier: GPL-2.0-or-later
"""What stands still: grains that hardly come down, and the layer of them at the wall of a hopper.

Lengths are in d.
"""

import numpy as np

from .passages import falls
from .stagnation import AXIS, SHARE, boundary

STILL = 0.5  # d; what has come down less in the interval stands still
RING = 1.0  # d, width of the rings, or somewhat more
HALF_SLAB = 1.0  # d
BLOCKS, LEAST = 4, 3  # of the interval for a standard error, and pairs in each


def still_share(first, last):
    """Of the grains above the base at the first snapshot, the share of those that stand still up to the last."""
    middle, fall = falls(first, last)
    above = np.count_nonzero(first.positions[:, 2] > 0)
    return float(np.count_nonzero((np.abs(fall) < STILL) & (middle[:, 2] > 0)) / above) if above else float("nan")


def stagnant_layer(pairs, height, radius):
    """[width, standard error] of the layer at the wall in which the mean fall is below ``SHARE`` of that within
    ``AXIS`` of the axis, at a height where the inside has a radius. 0 where all grains move; not a number where none
    does."""
    blocks = min(BLOCKS, len(pairs) // LEAST)
    sums = np.array([_rings(*pair, height, radius) for pair in pairs])  # pairs, counts and falls, rings
    error = float("nan")
    if blocks > 1:
        widths = [_width(block.sum(axis=0), radius) for block in np.array_split(sums, blocks)]
        error = float(np.std(widths, ddof=1) / np.sqrt(blocks))
    return [_width(sums.sum(axis=0), radius), error]


def _rings(before, after, height, radius):
    """Grains at a height, and how fast they fall in sum, d/tau, in rings around the axis; (2, rings)."""
    middle, fall = falls(before, after)
    slab = np.abs(middle[:, 2] - height) < HALF_SLAB
    place, edges = np.hypot(*middle[slab, :2].T), np.linspace(0, radius, _count(radius) + 1)
    weights = fall[slab] / (after.time - before.time)
    return np.array([np.histogram(place, edges)[0], np.histogram(place, edges, weights=weights)[0]])


def _count(radius):
    return max(int(radius / RING), 2)


def _width(sums, radius):
    rings = sums.shape[-1]
    both = np.concatenate([np.zeros_like(sums), sums], axis=-1)  # ``boundary`` adds up two sides
    edge = float(boundary(both[0], both[1], np.linspace(-radius, radius, 2 * rings + 1)))
    core = slice(max(int(AXIS / (radius / rings)), 1))
    with np.errstate(invalid="ignore", divide="ignore"):
        axis, wall = sums[1][core].sum() / sums[0][core].sum(), sums[1][-1] / sums[0][-1]
    if np.isfinite(edge):
        return radius - edge
    return 0.0 if wall > SHARE * axis > 0 else float("nan")
