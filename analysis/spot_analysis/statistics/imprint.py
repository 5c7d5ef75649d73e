# SPDX-License-Identifier: GPL-2.0-or-later
"""What a period leaves in sums over grains: the profile over the period, and its test against a flat one.

What is known of the scatter comes from blocks, several periods long: what grains of one block do is tied together by their
neighbours, over snapshots, and over runs from the same packing. So a block is one sample, summed over all of these.
"""

from dataclasses import dataclass

import numpy as np
from scipy import linalg, stats

from ..base.errors import AnalysisError
from .fold import BINS, DISTANCES

CELLS = 4  # periods in a block, which is a strip wide


@dataclass(frozen=True)
class Imprint:
    """profile, error : (DISTANCES,) from the end of a period to its middle, a quantity over its mean, with standard errors
    chi_square : of the profile against a flat one, with one degree of freedom less than bins, whose correlations are included
    p_value : chance of more without an imprint, by Hotelling's distribution, since the scatter is estimated too
    """

    profile: np.ndarray
    error: np.ndarray
    chi_square: float
    p_value: float
    blocks: int

    def depth(self):
        """Root mean square deviation from 1, and what scatter alone makes of it."""
        return np.sqrt(((self.profile - 1)**2).mean()), np.sqrt((self.error**2).mean())


def around(sums):
    """Mean over the length of a cell around each bin (strips, bins), without the outermost cells."""
    total = np.cumsum(np.pad(sums, ((0, 0), (1, 0))), axis=1)
    means = (total[:, BINS:] - total[:, :-BINS]) / BINS
    return means[:, BINS - BINS // 2:][:, :sums.shape[1] - 2 * BINS]


def imprint(sums, grains):
    """The Imprint of what is summed (strips, bins) over so many grains."""
    off = sums[:, BINS:-BINS] - around(sums) / around(grains) * grains[:, BINS:-BINS]
    cells = off.shape[1] // BINS // CELLS * CELLS
    off = off[:, :cells * BINS].reshape(-1, CELLS, BINS).sum(axis=1)
    off = (off + off[:, ::-1])[:, :DISTANCES] / 2
    weight = np.where(np.arange(DISTANCES) < BINS // 2, 2, 1)  # bins at this distance
    off -= (off @ weight / BINS)[:, None]
    blocks, freedom, scale = len(off), DISTANCES - 1, sums[:, BINS:(cells + 1) * BINS].sum() / BINS
    if len(off) <= DISTANCES:
        raise AnalysisError(f"{len(off)} blocks are too few for the scatter of {DISTANCES} bins: the silo is too narrow")
    samples = off @ linalg.null_space(weight[None].astype(float))
    mean = samples.mean(axis=0)
    chi_square = float(mean @ np.linalg.solve(np.cov(samples.T) / blocks, mean))
    return Imprint(1 + off.sum(axis=0) / scale, off.std(axis=0, ddof=1) * np.sqrt(blocks) / scale, chi_square,
                   float(stats.f.sf(chi_square * (blocks - freedom) / (freedom * (blocks - 1)), freedom, blocks - freedom)), blocks)
