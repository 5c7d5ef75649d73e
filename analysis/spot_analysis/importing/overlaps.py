# SPDX-License-Identifier: GPL-2.0-or-later
"""Overlaps of soft DEM, pushed apart: grains as hard as fix spot wants them at the start."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from ..base.errors import AnalysisError

DEEPEST = 0.3  # d: deeper overlaps are no packing at rest
FARTHEST = 0.5  # d that a grain may be moved
SWEEPS = 1000
SPARE = 0.25  # of the bound: pairs are pushed so much farther apart, which takes fewer sweeps


@dataclass(frozen=True)
class Relaxed:
    """positions : (n, 3); before, after : the largest overlap (d); moved : the farthest that a grain went (d); sweeps : made

    Of two grains d is the mean of their diameters.
    """

    positions: np.ndarray
    before: float
    after: float
    moved: float
    sweeps: int


def deepest_pair(positions, diameters):
    """(overlap in d, index, index) of the pair that overlaps most; an overlap of 0 where none does. diameters : (n,), or of all"""
    pairs, depths = _overlapping(positions, np.broadcast_to(diameters, len(positions)), 0.0)
    if not len(pairs):
        return 0.0, 0, 0
    deepest = int(np.argmax(depths))
    return float(depths[deepest]), *(int(index) for index in pairs[deepest])


def relax(positions, diameters, bound, walls=None, progress=lambda text: None):
    """Push pairs that overlap by more than ``bound`` (d) apart, and grains back inside; returns Relaxed.

    positions : (n, 3); diameters : (n,), or of all, in their unit; walls : with ``inside(positions, inset)``, see ``walls.py``

    Each sweep moves both grains of a pair by half of what is too much, all pairs at once (Jacobi). Raises AnalysisError
    where overlaps are deeper than DEEPEST, or where that does not come to an end within SWEEPS and FARTHEST.
    """
    diameters = np.broadcast_to(diameters, len(positions))
    before, one, other = deepest_pair(positions, diameters)
    if before > DEEPEST:
        raise AnalysisError(f"grains {one + 1} and {other + 1} (in the file's order of ids or lines) overlap by {before:.2f} d, more than "
                            f"{DEEPEST} d: no packing at rest; is the diameter {diameters[one]:g}, in the unit of the positions?")
    now, target = positions, (1 - SPARE) * bound
    for sweep in range(SWEEPS + 1):
        pairs, depths = _overlapping(now, diameters, bound)
        outside = walls is not None and (walls.distances(now) < (0.5 - bound) * diameters).any()
        if not len(pairs) and not outside:
            break
        now = now + _pushes(now, pairs, depths - target, diameters)
        if walls is not None:
            now = walls.inside(now, (0.5 - target) * diameters)
        progress(f"overlaps are pushed apart, sweep {sweep}, the largest {depths.max(initial=0):.3f} d")
    after = deepest_pair(now, diameters)[0]
    moved = float((np.linalg.norm(now - positions, axis=1) / diameters).max())
    if after > bound or outside or moved > FARTHEST:
        raise AnalysisError(f"overlaps of up to {before:.3f} d do not go below {bound:g} d without moving grains {moved:.2f} d (at most "
                            f"{FARTHEST} d, {SWEEPS} sweeps): give a smaller --diameter, or relax the packing by DEM with stiffer grains")
    return Relaxed(now, before, after, moved, sweep)


def _touching(pairs, diameters):
    """(m,) distances of centres at which pairs touch."""
    return (diameters[pairs[:, 0]] + diameters[pairs[:, 1]]) / 2


def _overlapping(positions, diameters, bound):
    """Pairs (m, 2) that overlap by more than ``bound`` (d), and by how much (m,) (d)."""
    pairs = cKDTree(positions).query_pairs((1 - bound) * diameters.max(), output_type="ndarray")
    depths = 1 - np.linalg.norm(positions[pairs[:, 0]] - positions[pairs[:, 1]], axis=1) / _touching(pairs, diameters)
    return pairs[depths > bound], depths[depths > bound]


def _pushes(positions, pairs, depths, diameters):
    """What a sweep moves each grain by, (n, 3); depths : that are too much (d)."""
    apart = positions[pairs[:, 0]] - positions[pairs[:, 1]]
    distance = np.linalg.norm(apart, axis=1)
    apart[distance == 0], distance[distance == 0] = [0, 0, 1], 1
    push = apart * (0.5 * depths * _touching(pairs, diameters) / distance)[:, None]
    moves = np.zeros_like(positions)
    np.add.at(moves, pairs[:, 0], push)
    np.add.at(moves, pairs[:, 1], -push)
    return moves
