# SPDX-License-Identifier: GPL-2.0-or-later
"""The numbers of two runs side by side, over the times that both have."""

import math
from dataclasses import dataclass

import numpy as np

from .bootstrap import MINIMUM_BLOCKS, BLOCK_TAU, block_sums, bootstrap_error
from .errors import AnalysisError
from .flow import profile_variance
from .run_statistics import TIME_TOLERANCE
from .structure import packing_fraction, slab_rdf

STEADY_FROM = 40.0  # tau; from here the DEM reference is steady below z = 70 d
FLUX_HEIGHTS = (2, 10, 30, 60)
SLAB = (50, 70)  # d; where 2006 counts grains
RDF_REBIN = 2  # stored bins in one of the 0.05 d that g(r) is compared in
CONTACT_PEAK = (0.95, 1.05)  # d; told apart, since its height depends on stiffness and bin width


@dataclass(frozen=True)
class Interval:
    """start, end in tau; kind: "steady", "everything" or "chosen"."""

    start: float
    end: float
    kind: str

    @property
    def span(self):
        return self.start, self.end

    def holds(self, times):
        return (times >= self.start - TIME_TOLERANCE) & (times <= self.end + TIME_TOLERANCE)


@dataclass(frozen=True)
class Value:
    """A number with its unit and standard error; None where it cannot be known."""

    unit: str
    value: float = None
    error: float = None


@dataclass(frozen=True)
class Row:
    """One line of the comparison."""

    name: str
    unit: str
    dem: float
    dem_error: float
    spot: float
    spot_error: float
    difference: float

    def as_dict(self):
        return {key: getattr(self, key) for key in ("unit", "dem", "dem_error", "spot", "spot_error", "difference")}


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


class IntervalView:
    """One run seen over the common times and the chosen interval.

    run : RunStatistics
    common : indices of the run's snapshots at the common times
    interval : Interval
    """

    def __init__(self, run, common, interval):
        self.run = run
        self.interval = interval
        self.common = common
        self.snapshots = common[interval.holds(run.times[common])]
        self._pairs = self._common_pairs()

    def _common_pairs(self):
        """Pairs of snapshots inside the interval, both ends at common times."""
        run, shared = self.run, self.run.times[self.snapshots]

        def is_shared(times):
            return np.isclose(times[:, None], shared, rtol=0, atol=1e-9).any(axis=1)

        return np.flatnonzero(is_shared(run.profile_start) & is_shared(run.profile_end))

    def mean(self, unit, samples):
        """Mean over snapshots of ``samples`` (T,), those that are no number left out."""
        chosen = samples[self.snapshots]
        known = np.isfinite(chosen)
        if not known.any():
            return Value(unit)
        columns = np.column_stack([chosen, np.ones(len(chosen))])[known]
        return self._from_sums(unit, self._snapshot_sums(columns, known), _ratio)

    def flux(self, level):
        """Grains that cross ``level``, 1/tau."""
        return self._flux_ratio("1/tau", level, np.diff(self.run.times[self.snapshots]))

    def flux_over_outflow(self, level):
        """Flux through ``level`` over the flux through z = 0."""
        return self._flux_ratio("1", level, self._crossings(0))

    def _crossings(self, level):
        return -np.diff(self.run.count_above(level)[self.snapshots])

    def _flux_ratio(self, unit, level, denominator):
        if level > self.run.levels[-1] or denominator.sum() == 0:
            return Value(unit)
        times = self.run.times[self.snapshots]
        columns = np.column_stack([self._crossings(level), denominator]).astype(float)
        middles = (times[:-1] + times[1:]) / 2
        return self._from_sums(unit, block_sums(middles, columns, self.interval.span), _ratio)

    def profile(self, index):
        """Mean downward velocity across x at profile height number ``index``, (X,) d/tau; None without data."""
        if not len(self._pairs):
            return None
        counts = self.run.profile_counts[self._pairs, index].sum(axis=0)
        with np.errstate(invalid="ignore", divide="ignore"):
            return self.run.profile_sums[self._pairs, index].sum(axis=0) / counts

    def profile_variance(self, index):
        """Second moment in x of the velocity profile over |x| < walls - 1 d, d^2."""
        run, pairs = self.run, self._pairs
        if not len(pairs):
            return Value("d^2")
        bins = len(run.profile_edges) - 1
        columns = np.hstack([run.profile_counts[pairs, index], run.profile_sums[pairs, index]]).astype(float)
        middles = (run.profile_start[pairs] + run.profile_end[pairs]) / 2
        half_width = run.scene.container().half_width - 1

        def variance(sums):
            return profile_variance(sums[..., :bins], sums[..., bins:], run.profile_edges, half_width)

        return self._from_sums("d^2", block_sums(middles, columns, self.interval.span), variance)

    def rdf_sums(self):
        """(k, bins + 2): partners in each bin of g(r), grains and frames, summed over blocks of time."""
        return self._snapshot_sums(*self._rdf_columns(self.snapshots))

    def initial_rdf_sums(self):
        """The same of the run's first snapshot, (bins + 2,)."""
        return self._rdf_columns(np.array([0]))[0].sum(axis=0)

    def _rdf_columns(self, snapshots):
        run = self.run
        counts = run.rdf_counts[snapshots].reshape(len(snapshots), -1, RDF_REBIN).sum(axis=2)
        known = counts.sum(axis=1) > 0
        columns = np.column_stack([counts, run.region_grains[snapshots], np.ones(len(snapshots))])
        return columns[known].astype(float), known

    def rdf(self, sums):
        """g(r) from ``rdf_sums`` added up, (..., bins); not a number without data."""
        with np.errstate(invalid="ignore", divide="ignore"):
            return slab_rdf(sums[..., :-2], sums[..., -2], sums[..., -1], self.run.region(),
                            self.run.scene.container(), rdf_edges(self.run))

    def rdf_value(self, unit, statistic):
        """Value of ``statistic``, which maps g(r) (..., bins) to (...)."""
        return self._from_sums(unit, self.rdf_sums(), lambda sums: statistic(self.rdf(sums)))

    def _snapshot_sums(self, columns, known):
        return block_sums(self.run.times[self.snapshots][known], columns, self.interval.span)

    @staticmethod
    def _from_sums(unit, sums, statistic):
        value = float(statistic(sums.sum(axis=0)))
        if not math.isfinite(value):
            return Value(unit)
        error = bootstrap_error(sums, statistic)
        return Value(unit, value, error if error is not None and math.isfinite(error) else None)


def _ratio(sums):
    with np.errstate(invalid="ignore", divide="ignore"):
        return sums[..., 0] / sums[..., 1]


def rdf_edges(run):
    return run.rdf_edges[::RDF_REBIN]


def rdf_distance(run, one, other):
    """Root mean square of the difference of two g(r), (..., bins), beyond the contact peak."""
    beyond = rdf_edges(run)[:-1] > CONTACT_PEAK[1] - 1e-9
    return np.sqrt(((one - other)[..., beyond]**2).mean(axis=-1))


def _contact_peak(run, rdf):
    edges = rdf_edges(run)
    return rdf[..., (edges[:-1] > CONTACT_PEAK[0] - 1e-9) & (edges[1:] < CONTACT_PEAK[1] + 1e-9)].mean(axis=-1)


def quantities(view):
    """Every number of one run by its name, as Value, in the order of the table."""
    run = view.run
    container, region = run.scene.container(), run.region()
    above = run.count_above(0)[view.common]
    slab = run.count_above(SLAB[0]) - run.count_above(SLAB[1])
    slab_count = view.mean("grains", slab.astype(float)) if run.levels[-1] >= SLAB[1] else Value("grains")
    named = {
        "grains_initial": Value("grains", int(above[0])),
        "grains_left": Value("grains", int(above[-1])),
        "grains_drained": Value("grains", int(above[0] - above[-1])),
        "outflow": view.flux(0),
    }
    named.update({f"flux_{z}d": view.flux(z) for z in FLUX_HEIGHTS})
    named.update({f"flux_{z}d_over_outflow": view.flux_over_outflow(z) for z in FLUX_HEIGHTS})
    named["slab_count"] = slab_count
    named["density_drop"] = _drop("grains", slab_count, slab[0], 1)
    named["density_drop_fraction"] = _drop("1", slab_count, slab[0], slab[0])
    named.update({f"profile_variance_{z:g}d": view.profile_variance(index)
                  for index, z in enumerate(run.profile_heights)})
    volume_share = packing_fraction(run.region_grains, region, container)
    named["packing_fraction"] = view.mean("1", np.where(np.isfinite(run.badness), volume_share, math.nan))
    named["contacts_per_grain"] = view.mean("1", run.contacts)
    named["badness"] = view.mean("1", run.badness)
    named["largest_overlap_region"] = view.mean("d", run.region_largest_overlap)
    named["largest_overlap"] = Value("d", float(run.largest_overlap[view.snapshots].max()))
    named["largest_wall_overlap"] = Value("d", float(run.largest_wall_overlap[view.snapshots].max()))
    named["grains_outside"] = Value("grains", int(run.outside[view.common].max()))
    named["rdf_contact_peak"] = view.rdf_value("1", lambda rdf: _contact_peak(run, rdf))
    initial = view.rdf(view.initial_rdf_sums())
    named["rdf_l2_initial"] = view.rdf_value("1", lambda rdf: rdf_distance(run, rdf, initial))
    return named


def _drop(unit, slab_count, initial, scale):
    """Grains that the slab lost since the run's first snapshot."""
    if slab_count.value is None or scale == 0:
        return Value(unit)
    error = None if slab_count.error is None else slab_count.error / scale
    return Value(unit, (float(initial) - slab_count.value) / scale, error)


def compare(dem_view, spot_view):
    """The rows of the comparison; difference is spot less DEM."""
    dem, spot = quantities(dem_view), quantities(spot_view)
    rows = [_row(name, dem[name], spot[name]) for name in dem]
    distance = _rdf_between(dem_view, spot_view)
    change = dem["rdf_l2_initial"].value
    rows.append(Row("rdf_l2", "1", None, None, distance, None, distance))
    ratio = distance / change if distance is not None and change else None
    rows.append(Row("rdf_l2_ratio", "1", None, None, ratio, None, None))
    return rows


def _row(name, dem, spot):
    known = dem.value is not None and spot.value is not None
    return Row(name, dem.unit, dem.value, dem.error, spot.value, spot.error, spot.value - dem.value if known else None)


def _rdf_between(dem_view, spot_view):
    """Distance of the two runs' g(r)."""
    one, other = (view.rdf(view.rdf_sums().sum(axis=0)) for view in (dem_view, spot_view))
    distance = float(rdf_distance(dem_view.run, one, other))
    return distance if math.isfinite(distance) else None
