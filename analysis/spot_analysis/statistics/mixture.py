# SPDX-License-Identifier: GPL-2.0-or-later
"""How a mixture of sizes drains from a flat box: outflow, profiles of the fall, composition of what leaves, mixing.

Volumes are those of the grains, from their radii. d is the scene's diameter, which is that of a grain of mean volume, so
that volumes in pi/6 d^3 are grains of mean volume; times are in tau = sqrt(d/g). Large grains are those whose radius is
above the mean of the smallest and the largest. Standard errors are over pairs of successive snapshots.
"""

from dataclasses import dataclass

import numpy as np

from .axial_flow import mean_of
from .lacey import lacey_index
from .passages import Snapshot, common, drained, falls, outflow, snapshots_of, within
from .residence_by_size import LEVEL, residence
from .surface_share import surface_share

HEIGHTS = (5.0, 10.0)  # d, of the profiles
HALF_SLAB = 1.0  # d
STRIP = 2.0  # d, width of the strips of a profile along |x|
CORE = 6.0  # d, |x| within which packing fraction and the fall of either size are counted
BULK = (5.0, 15.0)  # d, heights between which the packing fraction is counted
SLICE = 5.0  # tau, in which the composition of what leaves is counted


@dataclass(frozen=True)
class _Snapshot(Snapshot):
    volumes: np.ndarray
    large: np.ndarray

    @property
    def inside(self):
        return self.positions[:, 2] > 0


def measure(frames, scene, start, end):
    """Quantity -> [value, standard error].

    frames : Frames of a drainage in the order of time, with the column radius; scene : Scene of the box
    start, end : the interval, tau

    Equal grains count as small ones. Raises ValueError if a frame has no radii, the first no grains, or if fewer than three
    snapshots lie in the interval.
    """
    snapshots = _snapshots(frames, scene)
    inside = within(snapshots, start, end)
    pairs = list(zip(inside, inside[1:]))
    outflow(pairs)  # refuses dumps that do not tell what leaves
    left = np.array([_left(before, after) for before, after in pairs])  # small, large
    times = np.array([after.time - before.time for before, after in pairs])
    found = {"outflow": mean_of(left.sum(axis=1) / times), "large_share_left": _share(left)}
    found.update(_composition(snapshots))
    for height in HEIGHTS:
        found.update(_profile(pairs, height, scene.half_width_x / scene.diameter))
        found[f"slower_large_{height:g}d"] = mean_of([_slower_large(*pair, height) for pair in pairs])
    found["packing_fraction"] = mean_of([_packing_fraction(s, scene) for s in inside])
    for name, snapshot in (("start", snapshots[0]), ("end", inside[-1])):
        grains = [values[snapshot.inside] for values in (snapshot.positions, snapshot.volumes, snapshot.large)]
        found[f"lacey_{name}"] = [lacey_index(grains[0], grains[2]), float("nan")]
        found[f"surface_share_{name}"] = [surface_share(*grains), float("nan")]
    small, large = residence(snapshots, start, end)
    found[f"residence_small_{LEVEL:g}d"], found[f"residence_large_{LEVEL:g}d"] = mean_of(small), mean_of(large)
    return found


def _snapshots(frames, scene):
    frames = list(frames)
    if any("radius" not in frame.extra for frame in frames):
        raise ValueError("the dumps have no column 'radius', which tells sizes; box.py takes equal grains without")
    if not frames or len(frames[0].ids) == 0:
        raise ValueError("the first snapshot has no grains")
    split = (frames[0].extra["radius"].min() + frames[0].extra["radius"].max()) / 2
    snapshots = []
    for frame, plain in zip(frames, snapshots_of(frames, scene)):
        radius = frame.extra["radius"]
        snapshots.append(_Snapshot(**vars(plain), volumes=(2 * radius / scene.diameter) ** 3, large=radius > split))
    return snapshots


def _left(before, after):
    """Volume of small and of large grains that has left through the orifice."""
    volumes = before.volumes * drained(before, after)
    return [volumes[before.large == large].sum() for large in (False, True)]


def _share(left):
    """That of large grains, whose error is the spread of what is over or missing in each pair."""
    share = left[:, 1].sum() / left.sum()
    residual = left[:, 1] - share * left.sum(axis=1)
    return [float(share), float(np.sqrt(len(left)) * residual.std(ddof=1) / left.sum())]


def _composition(snapshots):
    """Of what leaves, in slices of time from the opening on."""
    found, first = {}, snapshots[0]
    for snapshot in snapshots[1:]:
        if snapshot.time - first.time > SLICE - 1e-6:
            small, large = _left(first, snapshot)
            if small + large > 0:
                found[f"large_share_left_at_{(first.time + snapshot.time) / 2:.0f}tau"] = [large / (small + large), float("nan")]
            first = snapshot
    return found


def _common(before, after):
    """Of grains in both snapshots: index in the second, where they were between, d, and how fast they fall, d/tau."""
    first, second = common(before, after)
    stays = before.rounds[first] == after.rounds[second]
    middle, fall = falls(before, after)
    return second[stays], middle, fall / (after.time - before.time)


def _profile(pairs, height, half_width):
    """Rate of fall, each grain counted by its volume, in strips of |x| at a height."""
    edges = STRIP * np.arange(int(half_width / STRIP + 1e-6) + 1)
    speeds = []
    for before, after in pairs:
        index, middle, fall = _common(before, after)
        slab = np.abs(middle[:, 2] - height) < HALF_SLAB
        strip, weight = np.abs(middle[slab, 0]), after.volumes[index][slab]
        with np.errstate(invalid="ignore", divide="ignore"):
            speeds.append(np.histogram(strip, edges, weights=weight * fall[slab])[0] / np.histogram(strip, edges, weights=weight)[0])
    return {f"speed_{height:g}d_x{(low + high) / 2:.1f}d": mean_of(np.array(speeds)[:, k])
            for k, (low, high) in enumerate(zip(edges, edges[1:]))}


def _slower_large(before, after, height):
    index, middle, fall = _common(before, after)
    here = (np.abs(middle[:, 2] - height) < HALF_SLAB) & (np.abs(middle[:, 0]) < CORE)
    large = after.large[index]
    if not (here & large).any() or not (here & ~large).any():
        return float("nan")
    return (fall[here & ~large].mean() - fall[here & large].mean()) / fall[here].mean()


def _packing_fraction(snapshot, scene):
    """Grain volume by centres, from wall to wall in y."""
    x, _, z = snapshot.positions.T
    here = (np.abs(x) < CORE) & (z > BULK[0]) & (z < BULK[1])
    room = 2 * CORE * (2 * scene.half_depth_y / scene.diameter) * (BULK[1] - BULK[0])
    return snapshot.volumes[here].sum() * np.pi / 6 / room
