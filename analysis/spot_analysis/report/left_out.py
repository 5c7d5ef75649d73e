# SPDX-License-Identifier: GPL-2.0-or-later
"""Why statistics are unknown, in words: the first of the things that a statistic needs and a run does not have."""

import re

import numpy as np

from ..statistics.counts import SLAB
from ..statistics.interval import STEADY_FROM
from ..statistics.mean_flow import COVER
from ..statistics.neighbours import RDF_RANGE
from ..statistics.snapshot import LAG_TAU, TIME_TOLERANCE
from .by_name import by_name


def _stored(view, concept, name):
    return "the statistics are of an older format, without it" if concept.NAME in view.run.lacking else None


def _grains(view, concept, name):
    return None if view.run.grains[view.snapshots].any() else "there are no grains"


def _pairs(view, concept, name):
    """Snapshots that velocities can be taken from."""
    run = view.run
    if len(view.pair_rows(run.profile_start, run.profile_end)):
        return None
    apart = np.diff(run.times[view.snapshots])
    return f"no two snapshots are {LAG_TAU:g} tau apart" + (f" but {apart.min():g} tau and more" if len(apart) else "")


def _height(view, concept, name):
    """Grains as high up as the name of the quantity says."""
    number = re.search(r"_(\d+)d", name)
    needed = SLAB[1] if name.startswith(("slab", "density")) else int(number[1]) if number else 0
    top = view.run.levels[-1]
    return f"no grain is higher than z = {top:g} d" if top < needed else None


def _outflow(view, concept, name):
    return None if view.crossings(0).any() else "no grain leaves through z = 0"


def _structure(view, concept, name):
    if np.isfinite(view.run.badness[view.snapshots]).any():
        return None
    region = view.run.region()
    return f"no snapshot fills z = {region.bottom:g} d to {region.top + RDF_RANGE:g} d"


def _core(view, concept, name):
    """The core of the flow, full of grains from the statistic's BOTTOM to beyond its TOP."""
    part = view.run.measured[concept.NAME]
    rows = view.pair_rows(part.start, part.end)
    return None if len(rows) else f"no snapshot fills z = {concept.BOTTOM:g} d to {concept.TOP + COVER:g} d"


def _cells(view, concept, name):
    times = view.run.measured[concept.NAME].times
    return None if len(view.rows(times)) else f"no snapshot is at a multiple of {concept.PERIOD:g} tau"


def _start(view, concept, name):
    first = view.run.times[view.common[0]]
    return f"the first snapshot is at {first:g} tau" if first > concept.FIRST else None


def _steady(view, concept, name):
    return None if view.interval.is_steady() else f"the interval is not that of steady flow, from {STEADY_FROM:g} tau on"


def _end(view, concept, name):
    height = int(re.search(r"_(\d+)d", name)[1]) + concept.COVER
    covered = view.run.count_above(height)[view.snapshots[-1]] > 0
    return None if covered else f"no grain is above z = {height} d at the end"


def _filled(view, concept, name):
    return "grains do not fill the cells of the map at any height that counts"


def _uncensored(view, concept, name):
    return f"grains that leave from {view.interval.start:g} tau on may have stayed longer than since the start"


def _reach(view, concept, name):
    end, last = float(re.search(r"_(\d+)tau", name)[1]), view.run.times[view.common[-1]]
    return f"the run ends at {last:g} tau" if last < end - TIME_TOLERANCE else None


def _walls_across_y(view, concept, name):
    return "the silo repeats along y, where no walls stand" if view.run.scene.periodic_y else None


# By the names that the statistics have for them in NEEDS. What a need says comes before what the ones behind it say.
NEEDS = {"stored": _stored, "walls_across_y": _walls_across_y, "grains": _grains, "pairs": _pairs, "height": _height, "outflow": _outflow, "structure": _structure, "core": _core,
         "cells": _cells, "filled": _filled, "start": _start, "steady": _steady, "end": _end,
         "uncensored": _uncensored, "reach": _reach}


UNTOLD = "the interval does not tell it"


def why(view, concept, name):
    """Why the quantity ``name`` of the module ``concept`` is unknown in ``view``, an IntervalView."""
    reasons = (NEEDS[need](view, concept, name) for need in by_name(concept.NEEDS, name, ()))
    return next((reason for reason in reasons if reason), UNTOLD)


def of_runs(views, concept, name):
    """The same of several runs, name of the run -> view."""
    reasons = {run: why(view, concept, name) for run, view in views.items()}
    if set(reasons.values()) != {UNTOLD}:  # of a number that needs both, the run that has what it needs is not the cause
        reasons = {run: reason for run, reason in reasons.items() if reason != UNTOLD}
    if len(set(reasons.values())) == 1 and len(reasons) > 1:
        return next(iter(reasons.values()))
    return "; ".join(f"{run}: {reason}" for run, reason in reasons.items())


def summary(reasons):
    """One line that names every quantity of name -> reason, the same reasons together; None without any."""
    names = {}
    for name, reason in reasons.items():
        names.setdefault(reason, []).append(name)
    if not names:
        return None
    return "left out: " + "; ".join(f"{', '.join(some)} ({reason})" for reason, some in names.items())
