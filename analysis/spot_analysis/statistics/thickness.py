# SPDX-License-Identifier: GPL-2.0-or-later
"""Downward velocity and packing fraction across the thickness of the silo, in the structure region (2010)."""

import math

import numpy as np

from .flow import common_grains
from .snapshot import LAG_TAU

NAME = "thickness"
BIN = 0.125  # d
NEAR_WALL = 1.0  # d
SPEED_REBIN = 4
MEANING = {
    "speed_wall_over_middle": "v_z within 1 d of a wall over that in |y| < half",
    "packing_fraction_middle": "in the middle half of the thickness",
    "packing_wall_over_middle": "within 1 d of a wall over that",
}
NEEDS = {"*": ("walls_across_y", "structure", "pairs")}


class Measurement:
    """edges : (Y + 1,); times (T,), counts (T, Y): centres, 0 where the region is not full; start, end (P,), grains and
    speeds (P, Y): grains and sums of their downward velocity. T and P are 0 where there are no walls across y."""

    def __init__(self, container, region):
        self._region, self._walls = region, not container.periodic
        bins = max(int(round(2 * container.half_depth / BIN)), 2)
        self._edges = np.linspace(-1, 1, bins + 1) * container.half_depth
        self._counts, self._speeds = [], []

    def add(self, snapshot, history):
        if not self._walls:
            return
        bins = len(self._edges) - 1
        inside = self._region.contains(snapshot.positions) & snapshot.is_covered
        self._counts.append((snapshot.time, np.bincount(self._bins(snapshot.positions[inside]), minlength=bins)))
        start = history.earlier(LAG_TAU)
        if start is None or not snapshot.is_covered:
            return
        first, second = common_grains(start.ids, snapshot.ids)
        fall = start.positions[first] - snapshot.positions[second]
        middle = snapshot.positions[second] + fall / 2
        inside = self._region.contains(middle)
        place, speed = self._bins(middle[inside]), fall[inside, 2] / (snapshot.time - start.time)
        self._speeds.append((start.time, snapshot.time, np.bincount(place, minlength=bins),
                             np.bincount(place, speed, minlength=bins)))

    def _bins(self, positions):
        return np.searchsorted(self._edges[1:-1], positions[:, 1])

    def arrays(self):
        bins = len(self._edges) - 1
        times, counts = zip(*self._counts) if self._counts else ((), np.empty((0, bins), dtype=np.int64))
        start, end, grains, speeds = list(zip(*self._speeds)) or [[], [], np.empty((0, bins), dtype=np.int64),
                                                                  np.empty((0, bins))]
        return {"edges": self._edges, "times": np.array(times), "counts": np.array(counts), "start": np.array(start),
                "end": np.array(end), "grains": np.array(grains), "speeds": np.array(speeds)}


def solid_fraction(counts, snapshots, edges, area):
    """Share of each slice between ``edges`` that is inside a grain, (..., Y).

    counts : (..., Y) centres in each slice, summed over snapshots (...); area: of the region in x and z, d^2

    A centre is taken to be anywhere in its slice, so slices must be thin against d. The part of a sphere between its
    middle and a plane u <= 1/2 off is pi (u/4 - u^3/3).
    """
    middle = (edges[1:] + edges[:-1]) / 2
    u = np.clip(edges - middle[:, None], -0.5, 0.5)
    share = np.diff(math.pi * (u / 4 - u**3 / 3), axis=1)
    return counts @ share / (np.asarray(snapshots)[..., None] * area * np.diff(edges))


def _fraction_columns(part):
    filled = part.counts.sum(axis=1, keepdims=True) > 0
    return np.hstack([part.counts, filled])


def fraction_profile(view):
    """y (Y,) and packing fraction there over the interval (Y,)."""
    part = view.run.measured[NAME]
    sums = _fraction_columns(part)[view.rows(part.times)].sum(axis=0)
    return (part.edges[1:] + part.edges[:-1]) / 2, _fraction(view, part.edges, sums)


def _fraction(view, edges, sums):
    with np.errstate(invalid="ignore", divide="ignore"):
        return solid_fraction(sums[..., :-1], sums[..., -1], edges, view.run.region().area())


def speed_profile(view):
    """y (k,) and downward velocity there over the interval (k,), in bins of SPEED_REBIN; not a number without data."""
    part = view.run.measured[NAME]
    rows = view.pair_rows(part.start, part.end)
    grains, speeds = part.grains[rows].sum(axis=0), part.speeds[rows].sum(axis=0)
    starts = np.arange(0, len(grains), SPEED_REBIN)
    y = np.add.reduceat((part.edges[1:] + part.edges[:-1]) / 2, starts) / np.add.reduceat(np.ones(len(grains)), starts)
    with np.errstate(invalid="ignore", divide="ignore"):
        return y, np.add.reduceat(speeds, starts) / np.add.reduceat(grains, starts)


def quantities(view):
    part = view.run.measured[NAME]
    y = np.abs(part.edges[1:] + part.edges[:-1]) / 2
    half_depth = part.edges[-1]
    wall, middle = y > half_depth - NEAR_WALL, y < half_depth / 2
    bins = len(y)

    def slip(sums):
        grains, speeds = sums[..., :bins], sums[..., bins:]
        with np.errstate(invalid="ignore", divide="ignore"):
            near, far = (speeds[..., chosen].sum(axis=-1) / grains[..., chosen].sum(axis=-1) for chosen in (wall, middle))
            return near / far

    def ratio(sums):
        fraction = _fraction(view, part.edges, sums)
        return fraction[..., wall].mean(axis=-1) / fraction[..., middle].mean(axis=-1)

    def inner(sums):
        return _fraction(view, part.edges, sums)[..., middle].mean(axis=-1)

    columns = _fraction_columns(part)
    return {
        "speed_wall_over_middle": view.estimate_pairs("1", part.start, part.end,
                                                      np.hstack([part.grains, part.speeds]), slip),
        "packing_fraction_middle": view.estimate("1", part.times, columns, inner),
        "packing_wall_over_middle": view.estimate("1", part.times, columns, ratio),
    }
