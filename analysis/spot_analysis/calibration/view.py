# SPDX-License-Identifier: GPL-2.0-or-later
"""The interval of steady flow that a run is calibrated on, and Estimates from what was measured in it."""

import numpy as np

from ..statistics import particle_diffusion, velocity_correlation
from ..statistics.bootstrap import BLOCK_TAU, MINIMUM_BLOCKS
from ..statistics.interval import STEADY_FROM, Interval
from ..statistics.interval_view import IntervalView
from ..statistics.snapshot import LAG_TAU, TIME_TOLERANCE
from .estimate import CalibrationError, estimate

CONCEPTS = (velocity_correlation, particle_diffusion)  # of run_statistics.CONCEPTS, what is needed here


def view_of(run, start=None, end=None):
    """IntervalView of ``run`` over snapshots LAG_TAU apart, see ``choose_snapshots``; raises CalibrationError."""
    if abs(run.times[0]) > TIME_TOLERANCE:
        raise CalibrationError(f"the first snapshot is at t = {run.times[0]:g} tau; v_s needs the packing at rest, t = 0")
    chosen = choose_snapshots(run.times, start, end)
    return IntervalView(run, chosen, Interval(float(run.times[chosen[0]]), float(run.times[chosen[-1]]), "chosen"))


def choose_snapshots(times, start=None, end=None):
    """Indices of the snapshots of the interval, LAG_TAU apart; raises CalibrationError where there are too few.

    start, end : interval in tau; without ``start`` the longest stretch from STEADY_FROM on with a snapshot every LAG_TAU
    """
    first = STEADY_FROM if start is None else start
    last = times[-1] if end is None else end
    stretches = _stretches(times, first, last)
    wanted = MINIMUM_BLOCKS * BLOCK_TAU
    if start is not None and len(stretches) > 1:
        gap = stretches[0][-1]
        raise CalibrationError(f"no snapshot {LAG_TAU:g} tau after that at {times[gap]:g} tau; velocities need one "
                               "every so often: choose --from and --to without a gap")
    longest = max(stretches, key=len, default=[])
    length = times[longest[-1]] - times[longest[0]] if len(longest) else 0
    if length < wanted - TIME_TOLERANCE:
        raise CalibrationError(f"too few snapshots: those {LAG_TAU:g} tau apart between {first:g} and {last:g} tau "
                               f"span {length:g} tau, but {wanted:g} are needed for errors ({MINIMUM_BLOCKS} blocks of "
                               f"{BLOCK_TAU:g} tau; the dumps hold {len(times)} snapshots, {times[0]:g} to "
                               f"{times[-1]:g} tau)")
    return np.array(longest)


def _stretches(times, first, last):
    """Lists of snapshots, each LAG_TAU after the one before; snapshots in between are passed over."""
    inside = np.flatnonzero((times >= first - TIME_TOLERANCE) & (times <= last + TIME_TOLERANCE))
    stretches = []
    for index in inside:
        passed = times[index] - times[stretches[-1][-1]] if stretches else np.inf
        if abs(passed - LAG_TAU) <= TIME_TOLERANCE:
            stretches[-1].append(index)
        elif passed > LAG_TAU:
            stretches.append([index])
    return stretches


def estimate_snapshots(view, samples, statistic):
    """Estimate from samples (T, f) of the run's snapshots."""
    return estimate(view.run.times[view.snapshots], samples[view.snapshots], view.interval.span, statistic)


def estimate_steps(view, samples, statistic):
    """Estimate from samples (n - 1, f) of the steps between the view's n snapshots."""
    times = view.run.times[view.snapshots]
    return estimate((times[1:] + times[:-1]) / 2, samples, view.interval.span, statistic)


def estimate_pairs(view, start, end, samples, statistic):
    """Estimate from samples (P, f) of pairs of snapshots at the times ``start`` and ``end`` (P,)."""
    rows = view.pair_rows(start, end)
    return estimate(((start + end) / 2)[rows], samples[rows], view.interval.span, statistic)


def require_cover(view, start, end, top):
    """Raises CalibrationError where the region that ends at ``top`` was not full of grains in every step, (P,) times."""
    known, wanted = len(view.pair_rows(start, end)), len(view.snapshots) - 1
    if known < wanted:
        raise CalibrationError(f"the packing is too low: it goes on above z = {top:g} d in {known} of {wanted} steps only")
