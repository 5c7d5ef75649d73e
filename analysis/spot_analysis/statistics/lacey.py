# SPDX-License-Identifier: GPL-2.0-or-later
"""How well two kinds of grains are mixed."""

import numpy as np

CELL = 4.0  # d, edge of the cells in which grains are counted
LEAST = 20  # grains in a cell that counts


def lacey_index(positions, large):
    """Lacey's mixing index of a random sample of two kinds (J. Appl. Chem. 4, 257, 1954): (s0^2 - s^2) / (s0^2 - sr^2).

    positions : (n, 3), d; large : (n,) bool

    s^2 is the variance of the share of large grains over cells of ``CELL``, each counted by its n grains, s0^2 = p (1 - p)
    that of grains apart, sr^2 that of a random mixture. Cells with fewer than ``LEAST`` grains do not count; not a number
    where fewer than two are left.
    """
    cells, cell = np.unique(np.floor(positions / CELL).astype(int), axis=0, return_inverse=True)
    cell = cell.ravel()
    count = np.bincount(cell, minlength=len(cells))
    share = np.bincount(cell, weights=large, minlength=len(cells)) / count
    full = count >= LEAST
    if np.count_nonzero(full) < 2:
        return float("nan")
    count, share = count[full], share[full]
    p = np.average(share, weights=count)
    apart, between = p * (1 - p), np.average((share - p) ** 2, weights=count)
    chance = apart * len(count) / count.sum()  # s0^2 / n in each cell, which counts n times
    return float((apart - between) / (apart - chance)) if apart > chance else float("nan")
