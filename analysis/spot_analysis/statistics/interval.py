# SPDX-License-Identifier: GPL-2.0-or-later
"""One run seen over an interval of time: means, fluxes and estimates with their standard errors."""

import math
from dataclasses import dataclass

import numpy as np

from ..base.errors import AnalysisError
from .bootstrap import BLOCK_TAU, MINIMUM_BLOCKS, block_sums, bootstrap_error
from .snapshot import TIME_TOLERANCE

STEADY_FROM = 40.0  # tau; from here the DEM reference is steady below z = 70 d


@dataclass(frozen=True)
class Interval:
    """start, end in tau; kind: "steady", "everything" or "chosen"."""

    start: float
    end: float
    kind: str

    @property
    def span(self):
        return self.start, self.end

    def is_steady(self):
        return self.start >= STEADY_FROM - TIME_TOLERANCE

    def holds(self, times):
        return (times >= self.start - TIME_TOLERANCE) & (times <= self.end + TIME_TOLERANCE)


@dataclass(frozen=True)
class Value:
    """A number with its unit and standard error; None where it cannot be known."""

    unit: str
    value: float = None
    error: float = None

    @classmethod
    def of(cls, unit, value, error=None):
        """The Value of a measured number, which is unknown if it is not finite."""
        if not math.isfinite(value):
            return cls(unit)
        return cls(unit, float(value), float(error) if error is not None and math.isfinite(error) else None)


def common_times(dem, spot):
    """Indices of the snapshots of both runs at the same times, (n,) and (n,).

    Raises AnalysisError where the two hold different scenes or share fewer than two times.
    """
    one, other = dem.scene.container(), spot.scene.container()
    for name in ("half_width", "half_depth", "orifice_radius"):
        if not math.isclose(getattr(one, name), getattr(other, name), rel_tol=1e-3):
            raise AnalysisError(f"the two runs have different containers: {name} is {getattr(one, name):g} d in DEM, "
                                f"{getattr(other, name):g} d in spot")
    nearest = np.abs(dem.times[:, None] - spot.times).argmin(axis=1)
    matched = np.flatnonzero(np.abs(dem.times - spot.times[nearest]) <= TIME_TOLERANCE)
    if len(matched) < 2:
        raise AnalysisError(f"DEM has snapshots at {_list_times(dem.times)} and spot at {_list_times(spot.times)}: "
                            "fewer than two times are common")
    return matched, nearest[matched]


def _list_times(times):
    shown = [f"{time:g}" for time in times]
    return ", ".join(shown if len(shown) <= 5 else [*shown[:4], "...", shown[-1]]) + " tau"


def choose_interval(times, start=None, end=None):
    """The interval to compare, from the common times.

    Without ``start`` the steady part, from STEADY_FROM on, if it is long enough for a standard error, else
    everything. Raises AnalysisError where fewer than two common times lie inside.
    """
    last = times[-1] if end is None else end
    if start is not None:
        kind = "chosen"
    elif last - STEADY_FROM >= MINIMUM_BLOCKS * BLOCK_TAU:
        start, kind = STEADY_FROM, "steady"
    else:
        start, kind = times[0], "everything" if end is None else "chosen"
    inside = times[(times >= start - TIME_TOLERANCE) & (times <= last + TIME_TOLERANCE)]
    if len(inside) < 2:
        raise AnalysisError(f"fewer than two common snapshots between {start:g} and {last:g} tau "
                            f"(common times: {_list_times(times)})")
    return Interval(float(inside[0]), float(inside[-1]), kind)


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
