# SPDX-License-Identifier: GPL-2.0-or-later
"""b_p: diffusion length of the grains, half the slope of the variance of x against the height they dropped (2006).

Stored are the sums that ``mean_flow`` speaks of, over a grain at one step and at the step l later. They give the
autocovariances c_l of what the mean flow leaves, for any choice of times, and from them

    Var_m = m c_0 + 2 sum_{l < m} (m - l) c_l

after m steps. Each product counts at its own time, so paths that overlap do not tie blocks of time together.
"""

from collections import deque

import numpy as np

from .fits import fit_line
from .flow import common_grains
from .mean_flow import COVER, UPPER, Step, about_mean_flow, core, triangles
from .snapshot import LAG_TAU, TIME_TOLERANCE

NAME = "particle_diffusion"
DROPS = np.arange(1.0, 6.0)  # d; below, grains rattle in their cages
LAGS = 14  # steps in which grains drop by 5 d, with some to spare
BOTTOM, TOP = 25.0, 66.0  # d; lower down streamlines converge too fast to take the mean flow out
MEANING = {"particle_diffusion": "b_p, from drops of 1-5 d"}
NEEDS = {"*": ("pairs", "core")}


def lagged_moments(step, later):
    """Sum of w w'^T, symmetric part (u,), over the grains of ``step``'s region that are near it still in ``later``, and
    their number."""
    ids, w = step.ids[step.inside], step.w[step.inside]
    first, second = common_grains(ids, later.ids)
    return triangles(w[first].T @ later.w[second]), len(first)


class Measurement:
    """P steps from a full region: start, end (P,), grains (P, LAGS), moments (P, LAGS, u), fallen (P,): sum of the drops.

    The products with the step l later stand at the earlier step; 0 where there was no such step.
    """

    def __init__(self, container, region):
        self._region = core(container, BOTTOM, TOP)
        self._recent = deque(maxlen=LAGS * 4)
        self._rows = {}

    def add(self, snapshot, history):
        start = history.earlier(LAG_TAU)
        if start is None:
            return
        newest = Step(start, snapshot, self._region)
        self._recent.append(newest)
        if self._region.is_covered(snapshot.positions, COVER):
            self._rows[newest.start] = (newest.end, np.zeros(LAGS, dtype=np.int64),
                                        np.zeros((LAGS, len(UPPER[0]))), newest.fallen)
        for step in self._recent:
            lag = round((newest.start - step.start) / LAG_TAU)
            exact = abs(newest.start - step.start - lag * LAG_TAU) <= TIME_TOLERANCE
            if exact and lag < LAGS and step.start in self._rows:
                _, grains, moments, _ = self._rows[step.start]
                moments[lag], grains[lag] = lagged_moments(step, newest)

    def arrays(self):
        columns = zip(*self._rows.values()) if self._rows else (
            [], np.empty((0, LAGS), dtype=np.int64), np.empty((0, LAGS, len(UPPER[0]))), [])
        named = {name: np.array(column) for name, column in zip(("end", "grains", "moments", "fallen"), columns)}
        return {"start": np.array(list(self._rows)), **named}


def columns(part, end):
    """(P, f): the arrays side by side, without the steps that end after ``end``."""
    known = part.start[:, None] + LAG_TAU * np.arange(1, LAGS + 1) <= end + TIME_TOLERANCE
    return np.hstack([part.fallen[:, None] * known[:, :1], part.grains * known,
                      (part.moments * known[..., None]).reshape(len(part.start), LAGS * len(UPPER[0]))])


def variances(sums):
    """Variance of x about the mean flow after each of DROPS, (..., D), d^2, from summed ``columns`` (..., f)."""
    fallen, grains, moments = np.split(sums, [1, 1 + LAGS], axis=-1)
    moments = moments.reshape(*moments.shape[:-1], LAGS, len(UPPER[0]))
    with np.errstate(invalid="ignore", divide="ignore"):
        covariance = about_mean_flow(moments[..., 0, :], moments) / grains
        drop = fallen[..., 0] / grains[..., 0]
    steps, lag = np.arange(1, LAGS + 1)[:, None], np.arange(LAGS)
    weights = np.where(lag < steps, (steps - lag) * np.where(lag == 0, 1, 2), 0)
    return _at_drops(drop, _cumulative(covariance, weights))


def _cumulative(covariance, weights):
    """Variance after 0 ... LAGS steps (..., LAGS + 1); not a number from the first unknown covariance on."""
    known = np.isfinite(covariance)
    total = np.where(known, covariance, 0) @ weights.T
    total = np.where(np.logical_and.accumulate(known, axis=-1), total, np.nan)
    return np.concatenate([np.zeros((*total.shape[:-1], 1)), total], axis=-1)


def _at_drops(drop, variance):
    """The variances at DROPS, interpolated between whole steps of mean height ``drop`` (...)."""
    with np.errstate(invalid="ignore", divide="ignore"):
        place = np.where(drop > 0, 1, np.nan)[..., None] * DROPS / drop[..., None]
        place = np.where(place <= LAGS, place, np.nan)
    step = np.nan_to_num(place).astype(np.int64).clip(0, LAGS - 1)
    before, after = (np.take_along_axis(variance, step + k, -1) for k in (0, 1))
    return before + (place - step) * (after - before)


def diffusion_length(sums):
    """b_p (...), d."""
    return fit_line(DROPS, variances(sums))[0] / 2


def mean_variances(view):
    """The variances over the interval, (D,); None without data."""
    part = view.run.measured[NAME]
    rows = view.pair_rows(part.start, part.end)
    return variances(columns(part, view.interval.end)[rows].sum(axis=0)) if len(rows) else None


def quantities(view):
    part = view.run.measured[NAME]
    return {"particle_diffusion": view.estimate_pairs("d", part.start, part.end, columns(part, view.interval.end),
                                                      diffusion_length)}
