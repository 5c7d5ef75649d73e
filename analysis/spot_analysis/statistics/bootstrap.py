# SPDX-License-Identifier: GPL-2.0-or-later
"""Standard errors of correlated samples: bootstrap over blocks of time."""

import numpy as np

BLOCK_TAU = 6.0
MINIMUM_BLOCKS = 4
RESAMPLES = 1000
SEED = 20060513


def block_sums(times, samples, span, block=BLOCK_TAU):
    """Sums of the samples over blocks of equal duration, at least ``block``.

    times : (n,) tau, within ``span`` = (start, end)
    samples : (n, f)
    Returns (k, f); blocks without a sample are left out. Grains are pushed by the same avalanches for some tau,
    so shorter blocks would treat one event as several.
    """
    start, end = span
    number = max(int((end - start) / block + 1e-9), 1)
    index = ((np.asarray(times) - start) / ((end - start) or 1.0) * number).astype(int).clip(0, number - 1)
    present, index = np.unique(index, return_inverse=True)
    sums = np.zeros((len(present), samples.shape[1]))
    np.add.at(sums, index, samples)
    return sums


def resampled(sums):
    """Sums (RESAMPLES, f) of as many blocks, drawn from those of ``block_sums``, (k, f). Which ones are drawn depends on k only.

    What follows from them varies by (k-1)/k of the variance of independent blocks: the root of k / (k-1) puts that right.
    """
    blocks = len(sums)
    weights = np.random.default_rng(SEED).multinomial(blocks, np.full(blocks, 1 / blocks), size=RESAMPLES)
    return weights @ sums


def bootstrap_error(sums, statistic):
    """Standard error of ``statistic`` (of summed samples), or None with fewer than MINIMUM_BLOCKS blocks.

    sums : (k, f) of ``block_sums``
    statistic : maps (..., f) to (...)
    """
    blocks = len(sums)
    if blocks < MINIMUM_BLOCKS:
        return None
    return float(np.std(statistic(resampled(sums))) * np.sqrt(blocks / (blocks - 1)))
