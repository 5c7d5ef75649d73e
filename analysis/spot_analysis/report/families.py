# SPDX-License-Identifier: GPL-2.0-or-later
"""The spot model judged by families of quantities: several seeds by their mean, against one or several runs of DEM."""

from dataclasses import dataclass, replace
from functools import reduce

import numpy as np

from ..statistics import (bond_angles, bond_order, counts, frame_correlation, front, packing, particle_diffusion, profile_width,
                          radial_distribution, residence, stagnation, thickness, through_time, velocity_correlation, voronoi)
from ..statistics.interval import choose_interval, common_times
from ..statistics.interval_view import IntervalView
from ..statistics.snapshot import TIME_TOLERANCE
from ..statistics.value import Value
from . import left_out
from .by_name import by_name
from .criteria import CRITERIA
from .pooling import mean, pool_runs, pool_seeds

# What is measured in a window, by its name.
BOTH = (counts, packing, radial_distribution, bond_angles, voronoi, profile_width, stagnation, residence, particle_diffusion,
        frame_correlation, velocity_correlation, thickness)
CONCEPTS = {"early": (*BOTH, front, bond_order), "late": BOTH, "end": (bond_order,), None: (through_time,)}


@dataclass(frozen=True)
class Verdict:
    """What was found for a Criterion.

    dem, spot : Values; differences of curves are the spot's, DEM has none
    met : whether the bound is met; None where it is not judged
    left_out : why it is not, or why the spot model has no value; without one where DEM has it, the bound is not met
    """

    dem: Value = Value("")
    spot: Value = Value("")
    met: bool = None
    left_out: str = None


def judge(dems, spots, windows, not_carried=None):
    """Criterion -> Verdict.

    dems : RunStatistics of DEM, one or several runs of the same silo; spots : of the spot model, a seed each
    windows : window -> (start, end), tau
    not_carried : pattern of the labels of criteria -> why they are not judged
    """
    found = {window: _measure(dems, spots, windows.get(window), concepts) for window, concepts in CONCEPTS.items()
             if window is None or window in windows}
    return {criterion: _verdict(criterion, found.get(criterion.window, {}), by_name(not_carried or {}, criterion.label, None))
            for criterion in CRITERIA}


def _verdict(criterion, found, not_carried):
    if not_carried is not None:
        return Verdict(left_out=not_carried)
    if criterion.name not in found:
        return Verdict(left_out="the runs do not reach it")
    dem, spot, known, reason = found[criterion.name]
    met = criterion.bound.is_met(dem, spot) if criterion.bound else None
    if criterion.bound and known and spot.value is None:
        met = False
    return Verdict(dem, spot, met, reason)


def _measure(dems, spots, span, concepts):
    """name -> DEM's Value, the spot model's, whether DEM knows it, and why one is unknown."""
    pairs = [views for dem in dems if (views := _views(dem, spots, span))]
    found = {}
    for concept in concepts:
        able = [(dem, some) for dem, some in pairs if _has(dem, concept)]
        if not able or not all(_has(spot, concept) for spot in able[0][1]):
            continue
        views = {"DEM": able[0][0], "spot": able[0][1][0]}
        own = [concept.quantities(dem) for dem, _ in able]
        theirs = [concept.quantities(spot) for spot in able[0][1]]
        for name in own[0]:
            dem, spot = pool_runs([one[name] for one in own if name in one]), pool_seeds([one[name] for one in theirs])
            found[name] = _entry(views, concept, name, dem, spot, dem.value is not None)
        if hasattr(concept, "between"):
            known = concept.between(able[0][0], able[0][0])
            apart = [[concept.between(dem, spot) for spot in some] for dem, some in able]
            for name, itself in known.items():
                spot = pool_seeds([mean([one[seed][name] for one in apart]) for seed in range(len(spots))])
                found[name] = _entry(views, concept, name, Value(spot.unit), spot, itself.value is not None)
    return found


def _entry(views, concept, name, dem, spot, known):
    lacking = {run: views[run] for run, missing in (("DEM", not known), ("spot", spot.value is None)) if missing}
    return dem, spot, known, left_out.of_runs(lacking, concept, name) if lacking else None


def _has(view, concept):
    """Whether the concept was measured: not in files of an older format, nor by those who measure a part only."""
    name = getattr(concept, "NAME", None)
    return name is None or (bool(vars(view.run.measured[name])) and name not in view.run.lacking)


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
