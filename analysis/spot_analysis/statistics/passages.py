# SPDX-License-Identifier: GPL-2.0-or-later
"""Snapshots of a drainage, and which grains have gone through the outlet between two of them, those that go round
included.

Grains that go round (fix spot, recirculate) leave at the outlet and come in again on top. How often each has done so is
read off a column of the dumps, f_ID[5] of fix spot with peratom. Without it a grain has gone round that has risen by
more than ``JUMP``. Lengths are in d, times in tau.
"""

from dataclasses import dataclass
from fnmatch import fnmatchcase

import numpy as np

ROUNDS = "f_*[[]5]"  # wildcard of the column's name
JUMP = 5.0  # d; no grain of a drainage rises so far by itself
MOST = 0.2  # of the grains may go round between two snapshots without a column that counts: twice would be seen as once
FALLING = 0.5  # d, by which grains come down on average; with less nothing need leave


@dataclass(frozen=True)
class Snapshot:
    """Sorted by id; rounds : (n,), how often each grain had gone round by then."""

    time: float
    ids: np.ndarray
    positions: np.ndarray
    rounds: np.ndarray

    @property
    def passages(self):
        """How often each has gone through the outlet; one on its way below has, too."""
        return self.rounds + (self.positions[:, 2] <= 0)


def snapshots_of(frames, scene):
    """Snapshots of Frames in the order of time; scene : any with ``Origin``.

    Raises ValueError if so many grains go round between two that their passages cannot be told.
    """
    found = []
    for frame in frames:
        positions, none = scene.positions(frame.positions), np.zeros(len(frame.ids), dtype=int)
        bare = Snapshot(scene.time(frame.timestep), frame.ids, positions, none)
        counted = _counted(frame)
        rounds = counted if counted is not None else _jumped(found[-1], bare) if found else bare.rounds
        found.append(Snapshot(bare.time, bare.ids, bare.positions, rounds))
    return found


def within(snapshots, start, end):
    """Those in the interval, tau; raises ValueError if there are fewer than three."""
    inside = [s for s in snapshots if start - 1e-9 <= s.time <= end + 1e-9]
    if len(inside) < 3:
        reach = f"; the run has {snapshots[0].time:g} to {snapshots[-1].time:g} tau" if snapshots else ""
        raise ValueError(f"{len(inside)} snapshots between {start:g} and {end:g} tau, at least 3 are needed{reach}")
    return inside


def _counted(frame):
    """Rounds of each grain from the column that counts them, None where there is none: other columns hold no whole
    numbers."""
    for values in (values for name, values in frame.extra.items() if fnmatchcase(name, ROUNDS)):
        if np.all((values >= 0) & (values == np.rint(values))):
            return values.astype(int)
    return None


def _jumped(before, after):
    """Rounds of each grain of ``after``, by those of ``before`` and by which have risen."""
    rounds = after.rounds.copy()
    first, second = common(before, after)
    up = after.positions[second, 2] - before.positions[first, 2] > JUMP
    if np.count_nonzero(up) > MOST * len(after.ids):
        raise ValueError(f"{np.count_nonzero(up)} of {len(after.ids)} grains go round between {before.time:g} and "
                         f"{after.time:g} tau, too many to tell how often each: dump more often, or "
                         "the column f_ID[5] of fix spot with 'peratom yes'")
    rounds[second] = before.rounds[first] + up
    return rounds


def common(before, after):
    """Indices in both snapshots of the grains that are in both."""
    return np.intersect1d(before.ids, after.ids, assume_unique=True, return_indices=True)[1:]


def drained(before, after):
    """How often each grain of ``before`` has gone through the outlet until ``after``, (n,); one that is gone has."""
    times = (before.positions[:, 2] > 0).astype(int)
    first, second = common(before, after)
    times[first] = after.passages[second] - before.passages[first]
    return times


def outflow(pairs):
    """Grains a tau that leave, for each pair of successive snapshots.

    Raises ValueError where none leaves, and grains fall but the bed does not: then they come in again where nobody sees
    it.
    """
    rates = [drained(*pair).sum() / (pair[1].time - pair[0].time) for pair in pairs]
    full = [pair for pair in pairs if len(pair[0].ids) and len(pair[1].ids)]
    fallen = sum(np.clip(falls(*pair)[1], 0, None).sum() / len(pair[0].ids) for pair in full)
    sunk = sum(pair[0].positions[:, 2].mean() - pair[1].positions[:, 2].mean() for pair in full)
    if not np.any(rates) and fallen > FALLING and sunk < fallen / 2:
        raise ValueError(f"no grain leaves, but grains come down by {fallen:.2g} d on average and the bed by "
                         f"{sunk:.2g} d: the dumps do not tell which go round; "
                         "dump the column f_ID[5] of fix spot with 'peratom yes'")
    return rates


def falls(before, after):
    """Of grains that are in both snapshots and did not go round between: where they were between, and how far they have
    come down."""
    first, second = common(before, after)
    stays = before.rounds[first] == after.rounds[second]
    first, second = first[stays], second[stays]
    return ((before.positions[first] + after.positions[second]) / 2,
            before.positions[first, 2] - after.positions[second, 2])


def residence_times(snapshots, level):
    """For each pair of successive snapshots: before, after, indices in the first of grains that leave then, (k,), and
    for how long, tau, they have been below a level. Grains that started below it are left out until they have gone round."""
    ids = np.unique(np.concatenate([s.ids for s in snapshots]))
    passed = np.full(len(ids), np.nan)
    for before, after in zip(snapshots, snapshots[1:]):
        first, second = common(before, after)
        stays = before.rounds[first] == after.rounds[second]
        grain, height = np.searchsorted(ids, before.ids), before.positions[:, 2]
        later = np.full(len(before.ids), -np.inf)
        later[first[stays]] = after.positions[second[stays], 2]
        passes = (height >= level) & (later < level) & np.isnan(passed[grain])
        share = (height[passes] - level) / (height[passes] - np.maximum(later[passes], 0.0))
        passed[grain[passes]] = before.time + share * (after.time - before.time)
        leaves = np.flatnonzero((height > 0) & (later <= 0) & np.isfinite(passed[grain]))
        yield before, after, leaves, (before.time + after.time) / 2 - passed[grain[leaves]]
        passed[grain[later <= 0]] = np.nan
