# SPDX-License-Identifier: GPL-2.0-or-later
"""A number with its block-bootstrap replicates, so that errors go through every formula that uses it."""

from dataclasses import dataclass

import numpy as np

from ..base.errors import AnalysisError
from ..statistics.bootstrap import BLOCK_TAU, MINIMUM_BLOCKS, block_sums, resampled

LOST_REPLICATES = 0.02  # share of resamples in which a fit may end at the border of its table


class CalibrationError(AnalysisError):
    """Data that cannot carry a fit, or that gave one which means nothing."""


@dataclass(frozen=True)
class Estimate:
    """value : () or (k,); replicates : (RESAMPLES,) or (RESAMPLES, k), scattered about it as the value is about the truth."""

    value: np.ndarray
    replicates: np.ndarray

    @property
    def error(self):
        """Standard error, shaped as ``value``."""
        return np.sqrt(_known_mean((self.replicates - _known_mean(self.replicates))**2))

    def is_determined(self, significance=3.0):
        """Whether a single value is positive beyond its error, in (nearly) every replicate a number."""
        known = np.isfinite(self.replicates).mean() > 1 - LOST_REPLICATES
        return bool(np.isfinite(self.value) and known and self.value > significance * self.error)

    def as_floats(self, scale=1.0):
        """A single value and its error, times ``scale``; what was chosen, not measured, has the error 0, rounding apart."""
        value, error = scale * float(self.value), scale * float(self.error)
        return value, error if error > 1e-12 * abs(value) else 0.0

    def __getitem__(self, index):
        return Estimate(self.value[index], self.replicates[:, index])


def estimate(times, samples, span, statistic):
    """Estimate of ``statistic`` (of summed samples) from blocks of at least BLOCK_TAU.

    times : (n,) tau, within ``span`` = (start, end)
    samples : (n, f)
    statistic : maps (..., f) to (...) or (..., k)

    Estimates over the same span resample the same blocks, so what they have in common cancels in ``combine``.
    Raises CalibrationError with fewer than MINIMUM_BLOCKS blocks.
    """
    sums = block_sums(times, np.asarray(samples, dtype=float), span)
    blocks = len(sums)
    if blocks < MINIMUM_BLOCKS:
        raise CalibrationError(f"only {blocks} blocks of {BLOCK_TAU:g} tau between {span[0]:g} and {span[1]:g} tau; "
                               f"a standard error needs {MINIMUM_BLOCKS}")
    value, values = statistic(sums.sum(axis=0)), statistic(resampled(sums))
    return Estimate(value, value + (values - _known_mean(values)) * np.sqrt(blocks / (blocks - 1)))


def _known_mean(replicates):
    """Mean of the replicates that are numbers; 0 where none is."""
    known = np.isfinite(replicates)
    return np.where(known, replicates, 0).sum(axis=0) / np.maximum(known.sum(axis=0), 1)


def combine(function, *estimates):
    """Estimate of a function of estimates, which must work on arrays."""
    return Estimate(function(*(e.value for e in estimates)), function(*(e.replicates for e in estimates)))
