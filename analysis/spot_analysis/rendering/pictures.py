# SPDX-License-Identifier: GPL-2.0-or-later
"""What is drawn of each snapshot: a slab of grains seen along y."""

from dataclasses import dataclass, field

import numpy as np

from ..base.errors import AnalysisError
from ..base.progress import share_of
from ..reading.dump import find_dumps
from ..statistics.snapshot import TIME_TOLERANCE

FRONT = 1.0  # d; depth of the layer at the front wall
MIDDLE = 1.0  # d to either side of the middle where no walls are known


@dataclass(frozen=True)
class Picture:
    """One snapshot, n grains, the far ones first; lengths in d, time in tau or steps.

    x, z, diameters : (n,); values : (n,), what they are coloured by, not a number where unknown
    spots : (m, 2) x and z of live spots in the slab
    """

    time: float
    x: np.ndarray
    z: np.ndarray
    diameters: np.ndarray
    values: np.ndarray
    spots: np.ndarray = field(default_factory=lambda: np.empty((0, 2)))


@dataclass(frozen=True)
class Reel:
    """The pictures of one run. colour : a key of COLOURINGS; container : walls, None where unknown; tau : whether times are in tau"""

    label: str
    colour: str
    colour_label: str
    container: object
    tau: bool
    pictures: list


def take_pictures(run, colour, colouring, slab, wanted, progress):
    """The Reel of the dumps of ``run``.

    slab : (low, high) in y; None takes the layer at the front wall, or the middle where no walls are known
    wanted : tells of a time whether it is drawn

    Raises AnalysisError where a slab that was asked for has no grain at any of these times, though there are some.
    """
    pictures, seen = [], []
    asked = slab
    files = len(find_dumps(run.path))
    for number, grains in enumerate(run.snapshots(), 1):
        colouring.see(grains)
        if slab is None and len(grains.ids):
            slab = _default_slab(run, grains)
        if not wanted(grains.time):
            continue
        chosen = np.zeros(0, dtype=bool) if slab is None else \
            (grains.positions[:, 1] >= slab[0]) & (grains.positions[:, 1] < slab[1])
        seen += [extent(grains.positions[:, 1]) for extent in (np.min, np.max) if len(grains.ids)]
        values = colouring.values(grains, chosen)
        x, y, z = grains.positions[chosen].T
        far_first = np.argsort(-y, kind="stable")
        spots = grains.spots if slab is None else grains.spots[(grains.spots[:, 1] >= slab[0]) & (grains.spots[:, 1] < slab[1])]
        pictures.append(Picture(grains.time, x[far_first], z[far_first], grains.diameters[chosen][far_first], values[far_first],
                                spots[:, [0, 2]]))
        progress(f"{run.label}: {len(pictures)} snapshots read", share_of(number, files))
    if asked is not None and seen and not any(len(picture.x) for picture in pictures):
        raise AnalysisError(f"{run.path}: no grain between y = {asked[0]:g} and {asked[1]:g} d (--slice); they are at "
                            f"{min(seen):.4g} to {max(seen):.4g} d")
    container = run.container and run.container.cut(slab)
    return Reel(run.label, colour, colouring.LABEL, container, run.scene is not None, pictures)


def _default_slab(run, grains):
    if run.has_front:
        return -np.inf, FRONT - run.container.half_depth
    middle = (grains.positions[:, 1].min() + grains.positions[:, 1].max()) / 2
    return middle - MIDDLE, middle + MIDDLE


def at_common_times(reels):
    """[(pictures of all reels at one time), ...]; raises AnalysisError where there is none."""
    if len({reel.tau for reel in reels}) > 1:
        without = next(reel.label for reel in reels if not reel.tau)
        raise AnalysisError(f"{without}: no scene.json, so its times can't be matched with those of the other run")
    tolerance = TIME_TOLERANCE if reels[0].tau else 0
    rows = []
    for first in reels[0].pictures:
        row = [next((picture for picture in reel.pictures if abs(picture.time - first.time) <= tolerance), None) for reel in reels]
        if None not in row:
            rows.append(row)
    if not rows:
        raise AnalysisError(f"{' and '.join(reel.label for reel in reels)}: no snapshot at a time that was asked for" +
                            (" and that all of them have" if len(reels) > 1 else ""))
    return rows
