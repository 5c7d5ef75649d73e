# SPDX-License-Identifier: GPL-2.0-or-later
"""The spot model judged by families of quantities: several seeds by their mean, against one or several runs of DEM.

A *window* is an interval that DEM and the spot model are seen over: "early", where the flow begins to be steady; "late", where it
has lasted; "end", where order has had the longest time to grow. Quantities through time have none.
"""

from dataclasses import dataclass, replace
from functools import reduce

import numpy as np

from ..statistics import (bond_angles, bond_order, counts, frame_correlation, front, packing, particle_diffusion, profile_width,
                          radial_distribution, residence, stagnation, thickness, through_time, velocity_correlation, voronoi)
from ..statistics.bootstrap import BLOCK_TAU, MINIMUM_BLOCKS
from ..statistics.interval import STEADY_FROM, choose_interval, common_times
from ..statistics.interval_view import IntervalView
from ..statistics.snapshot import TIME_TOLERANCE
from ..statistics.value import Value
from . import left_out
from .bounds import FAMILIES, Bound
from .by_name import by_name

WINDOWS = {"early": (STEADY_FROM, 90.0), "late": (200.0, 304.0), "end": (250.0, 304.0)}  # tau
BOTH = (counts, packing, radial_distribution, bond_angles, voronoi, profile_width, stagnation, residence, particle_diffusion,
        frame_correlation, velocity_correlation, thickness)
CONCEPTS = {"early": (*BOTH, front, bond_order), "late": BOTH, "end": (bond_order,), None: (through_time,)}
REPORTED = {"velocity": ("correlation_rms", "correlation_length")}  # family -> quantities without a bound


@dataclass(frozen=True)
class Criterion:
    """One row: a quantity of a family in a window, None for one through time; bound : None where it is reported only."""

    family: str
    name: str
    window: str
    bound: Bound

    @property
    def label(self):
        return self.name if self.window is None else f"{self.name}, {self.window}"


def _criteria():
    slices = [through_time.slice_name(quantity, span) for quantity in ("packing_fraction", "surface_angle")
              for span in through_time.SLICES]
    for family, bounds in FAMILIES.items():
        for pattern, bound in bounds.items():
            named = [name for name in slices if by_name({pattern: True}, name, False)]
            yield from (Criterion(family, name, None, bound) for name in named)
            if not named:
                windows = ("early",) if family == "front" else ("early", "end") if pattern == "crystal_share" else ("early", "late")
                yield from (Criterion(family, pattern, window, bound) for window in windows)
        yield from (Criterion(family, name, window, None) for name in REPORTED.get(family, ()) for window in ("early", "late"))


CRITERIA = tuple(_criteria())


@dataclass(frozen=True)
class Verdict:
    """What was found for a Criterion: Values of DEM and of the spot model, whether the bound is met (None: not judged), and why
    not where a value is missing. Differences of curves are the spot's; DEM has none."""

    dem: Value
    spot: Value
    met: bool
    left_out: str = None


def windows_of(last):
    """window -> (start, end), tau, of runs that end at ``last``: those of WINDOWS that leave enough time for a standard error."""
    spans = {name: (start, min(end, last)) for name, (start, end) in WINDOWS.items()}
    return {name: span for name, span in spans.items() if span[1] - span[0] >= MINIMUM_BLOCKS * BLOCK_TAU - 1e-9}


def pool_runs(values):
    """DEM's Value from several runs of the same silo: the mean, with an error of at least half of what they are apart."""
    known = [one for one in values if one.value is not None]
    if len(known) < 2:
        return known[0] if known else values[0]
    numbers = [one.value for one in known]
    errors = [one.error or 0 for one in known]
    error = max(np.sqrt(np.sum(np.square(errors))) / len(known), (max(numbers) - min(numbers)) / 2)
    return Value(known[0].unit, float(np.mean(numbers)), float(error))


def pool_seeds(values):
    """The spot model's Value: mean over seeds and its standard error from their spread, of one seed its own."""
    known = [one for one in values if one.value is not None]
    if len(known) < 2:
        return known[0] if known else values[0]
    numbers = [one.value for one in known]
    return Value(known[0].unit, float(np.mean(numbers)), float(np.std(numbers, ddof=1) / np.sqrt(len(numbers))))


def judge(dems, spots, windows, not_carried=None):
    """Criterion -> Verdict.

    dems : RunStatistics of DEM, one or several runs of the same silo; spots : of the spot model, a seed each
    windows : window -> (start, end), tau
    not_carried : pattern of the labels of criteria -> why they are not judged
    """
    found = {key: _measure(dems, spots, windows[key] if key else None, concepts)
             for key, concepts in CONCEPTS.items() if key is None or key in windows}
    return {criterion: _verdict(criterion, found.get(criterion.window), by_name(not_carried or {}, criterion.label, None))
            for criterion in CRITERIA}


def _verdict(criterion, found, reason):
    dem, spot, why = (found or {}).get(criterion.name, (Value(""), Value(""), None))
    if found is None:
        why = "the runs do not reach it"
    if reason is not None or spot.value is None:
        return Verdict(dem, spot, None, reason or why or "the run ends before")
    met = criterion.bound.is_met(dem, spot) if criterion.bound else None
    return Verdict(dem, spot, met, why if met is None and criterion.bound else None)


def _measure(dems, spots, span, concepts):
    """name -> DEM's Value, the spot model's, and why one is unknown."""
    pairs = [views for dem in dems if (views := _views(dem, spots, span))]
    found = {}
    for concept in concepts:
        if not pairs or any(_absent(view, concept) for dem, some in pairs for view in (dem, *some)):
            continue
        own = [concept.quantities(dem) for dem, _ in pairs]
        theirs = [concept.quantities(spot) for spot in pairs[0][1]]
        for name in own[0]:
            dem, spot = pool_runs([one[name] for one in own if name in one]), pool_seeds([one[name] for one in theirs])
            views = {"DEM": (dem, pairs[0][0]), "spot": (spot, pairs[0][1][0])}
            unknown = {run: view for run, (value, view) in views.items() if value.value is None}
            found[name] = dem, spot, left_out.of_runs(unknown, concept, name) if unknown else None
        if hasattr(concept, "between"):
            apart = [[concept.between(dem, spot) for spot in some] for dem, some in pairs]
            for name, first in apart[0][0].items():
                spot = pool_seeds([_mean([one[seed][name] for one in apart]) for seed in range(len(spots))])
                views = {"DEM": pairs[0][0], "spot": pairs[0][1][0]}
                found[name] = Value(first.unit), spot, left_out.of_runs(views, concept, name) if spot.value is None else None
    return found


def _absent(view, concept):
    return hasattr(concept, "NAME") and not vars(view.run.measured[concept.NAME])


def _mean(values):
    known = [one.value for one in values if one.value is not None]
    return Value(values[0].unit, float(np.mean(known))) if known else values[0]


def _views(dem, spots, span):
    """DEM's IntervalView and those of the spots over the times that all have, in ``span``; None where these do not reach it."""
    shared = [common_times(dem, spot) for spot in spots]
    common = reduce(np.intersect1d, (mine for mine, _ in shared))
    times = dem.times[common]
    if span is not None and (times[0] > span[0] + TIME_TOLERANCE or times[-1] < span[1] - TIME_TOLERANCE):
        return None
    interval = choose_interval(times) if span is None else replace(choose_interval(times, *span), kind="steady")
    return IntervalView(dem, common, interval), [IntervalView(spot, theirs[np.isin(mine, common)], interval)
                                                 for spot, (mine, theirs) in zip(spots, shared)]
