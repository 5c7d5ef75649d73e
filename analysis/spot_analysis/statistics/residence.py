# SPDX-License-Identifier: GPL-2.0-or-later
"""Residence times: how long a grain takes from a level down to the orifice."""

import numpy as np

from .value import Value

NAME = "residence"
LEVELS = np.array([10.0, 20.0])  # d
EDGES = np.linspace(0, 120, 61)  # tau
QUANTILES = {"p16": 0.16, "median": 0.5, "p84": 0.84}
MEANING = {
    "residence_median_*": "time from that level to the orifice",
    "residence_*": "the same, 16 % or 84 % of the grains are faster",
}
NEEDS = {"*": ("outflow", "height", "uncensored")}


class Measurement:
    """start, end (P,): successive snapshots; counts (P, levels, bins): grains that left between, by residence time.

    A grain's time starts when it passes the level, interpolated between two snapshots; grains that started below it
    are left out. It ends in the middle between the last snapshot in which the grain is above z = 0 and the next one:
    programs remove grains at different heights below. Times beyond the last edge are counted in the last bin; those
    longer than since the first snapshot cannot occur, in either run.
    """

    def __init__(self, container, region):
        self._rows = []
        self._passed = None

    def add(self, snapshot, history):
        before, first = history.previous, history.first
        if self._passed is None:
            self._passed = np.full((len(LEVELS), len(first.ids)), np.nan)
        if before is not None:
            self._rows.append((before.time, snapshot.time, self._count(before, snapshot, first)))

    def _count(self, before, snapshot, first):
        origin = first.index_of(before.ids)
        place = snapshot.index_of(before.ids)
        height = before.positions[:, 2]
        later = np.full(len(height), -np.inf)
        later[place >= 0] = snapshot.positions[place[place >= 0], 2]
        known = (origin >= 0) & (height > 0)
        origin, height, later = origin[known], height[known], later[known]
        duration = snapshot.time - before.time
        counts = []
        for level, passed in zip(LEVELS, self._passed):
            passes = np.flatnonzero((height >= level) & (later < level) & np.isnan(passed[origin]))
            share = (height[passes] - level) / (height[passes] - np.maximum(later[passes], 0))
            passed[origin[passes]] = before.time + duration * share
            leaves = later <= 0
            stayed = (before.time + snapshot.time) / 2 - passed[origin[leaves]]
            stayed = np.clip(stayed[np.isfinite(stayed)], 0, EDGES[-1] - 1e-6)
            counts.append(np.bincount((stayed / EDGES[1]).astype(np.int64), minlength=len(EDGES) - 1))
        return np.array(counts)

    def arrays(self):
        columns = list(zip(*self._rows)) or [[], [], np.empty((0, len(LEVELS), len(EDGES) - 1), dtype=np.int64)]
        return {name: np.array(column) for name, column in zip(("start", "end", "counts"), columns)}


def quantile(counts, share):
    """Residence time that ``share`` of the grains stay below, (...) tau, interpolated in the bins of counts (..., k);
    not a number without grains."""
    total = counts.sum(axis=-1)
    cumulative = np.concatenate([np.zeros((*counts.shape[:-1], 1)), np.cumsum(counts, axis=-1)], axis=-1)
    wanted = share * total
    place = np.clip((cumulative < wanted[..., None]).sum(axis=-1) - 1, 0, counts.shape[-1] - 1)
    below, above = (np.take_along_axis(cumulative, (place + k)[..., None], -1)[..., 0] for k in (0, 1))
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(total > 0, EDGES[place] + EDGES[1] * (wanted - below) / (above - below), np.nan)


def distribution(view, index):
    """Share of the grains in each bin over the interval, per tau, for level number ``index``; (k,)"""
    part = view.run.measured[NAME]
    counts = part.counts[view.pair_rows(part.start, part.end), index].sum(axis=0)
    with np.errstate(invalid="ignore", divide="ignore"):
        return counts / counts.sum() / np.diff(EDGES)


def quantities(view):
    """Quantiles that the length of the run does not cut off: a grain that leaves at time t cannot have stayed longer than t, so
    they are known up to the time at which the interval begins."""
    part = view.run.measured[NAME]
    named = {}
    for index, level in enumerate(LEVELS):
        for name, share in QUANTILES.items():
            value = view.estimate_pairs("tau", part.start, part.end, part.counts[:, index],
                                        lambda sums, share=share: quantile(sums, share))
            known = value.value is not None and value.value <= min(view.interval.start, EDGES[-2])
            named[f"residence_{name}_{level:g}d"] = value if known else Value("tau")
    return named
