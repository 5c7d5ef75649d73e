# SPDX-License-Identifier: GPL-2.0-or-later
"""One run seen over an interval of time: means, fluxes and estimates with their standard errors."""

import math

import numpy as np

from .bootstrap import block_sums, bootstrap_error
from .interval import Interval, choose_interval
from .value import Value


def whole_run(run):
    """IntervalView of a run by itself, over the interval that is chosen without another; all of it if it is a single snapshot."""
    interval = choose_interval(run.times) if len(run.times) > 1 else Interval(run.times[0], run.times[0], "everything")
    return IntervalView(run, np.arange(len(run.times)), interval)


class IntervalView:
    """One run seen over the common times and the chosen interval.

    run : RunStatistics
    common : indices of the run's snapshots at the common times
    interval : Interval
    snapshots : those of ``common`` that lie in the interval
    """

    def __init__(self, run, common, interval):
        self.run = run
        self.interval = interval
        self.common = common
        self.snapshots = common[interval.holds(run.times[common])]

    def rows(self, times):
        """Indices of the ``times`` (n,) at which snapshots of the interval were taken."""
        return np.flatnonzero(self._is_shared(times))

    def pair_rows(self, start, end):
        """Indices of the pairs, with times start and end (n,), whose both ends are snapshots of the interval."""
        return np.flatnonzero(self._is_shared(start) & self._is_shared(end))

    def _is_shared(self, times):
        return np.isclose(np.asarray(times)[:, None], self.run.times[self.snapshots], rtol=0, atol=1e-9).any(axis=1)

    def estimate(self, unit, times, columns, statistic, minimum=1):
        """Value of ``statistic``, which maps sums over time (..., f) to (...).

        times : (n,); columns : (n, f) samples at these; those in the interval are added up
        minimum : with fewer of them the value is unknown
        """
        rows = self.rows(times)
        return self._estimate(unit, times[rows], columns[rows], statistic, minimum)

    def estimate_pairs(self, unit, start, end, columns, statistic):
        """The same for samples that belong to pairs of snapshots at start and end (n,)."""
        rows = self.pair_rows(start, end)
        return self._estimate(unit, ((start + end) / 2)[rows], columns[rows], statistic, 1)

    def _estimate(self, unit, times, columns, statistic, minimum):
        if len(times) < minimum:
            return Value(unit)
        sums = block_sums(times, columns.astype(float), self.interval.span)
        value = float(statistic(sums.sum(axis=0)))
        return Value.of(unit, value, bootstrap_error(sums, statistic) if math.isfinite(value) else None)

    def mean(self, unit, samples):
        """Mean over snapshots of ``samples`` (T,), those that are no number left out."""
        return self.mean_of(unit, self.run.times, samples)

    def mean_of(self, unit, times, samples):
        """Mean of ``samples`` taken at ``times`` (n,), those that are no number left out."""
        known = np.isfinite(samples)
        columns = np.column_stack([samples, np.ones(len(samples))])[known]
        return self.estimate(unit, times[known], columns, ratio)

    def last_of(self, unit, times, samples):
        """The last of the ``samples`` taken at ``times`` (n,) in the interval."""
        rows = self.rows(times)
        return Value.of(unit, samples[rows[-1]]) if len(rows) else Value(unit)

    def flux(self, level):
        """Grains that cross ``level``, 1/tau."""
        return self._flux_ratio("1/tau", level, np.diff(self.run.times[self.snapshots]))

    def flux_over_outflow(self, level):
        """Flux through ``level`` over the flux through z = 0."""
        return self._flux_ratio("1", level, self.crossings(0))

    def crossings(self, level):
        """Grains that crossed ``level`` between successive snapshots of the interval."""
        return -np.diff(self.run.count_above(level)[self.snapshots])

    def _flux_ratio(self, unit, level, denominator):
        if level > self.run.levels[-1] or denominator.sum() == 0:
            return Value(unit)
        times = self.run.times[self.snapshots]
        columns = np.column_stack([self.crossings(level), denominator])
        return self._estimate(unit, (times[:-1] + times[1:]) / 2, columns, ratio, 1)


def ratio(sums):
    """First over second of summed columns (..., 2)."""
    with np.errstate(invalid="ignore", divide="ignore"):
        return sums[..., 0] / sums[..., 1]
