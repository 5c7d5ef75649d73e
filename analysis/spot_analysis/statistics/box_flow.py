# SPDX-License-Identifier: GPL-2.0-or-later
"""How equal grains flow in a box with one or several outlets in its base: outflow of each, profiles of the fall along x, packing
fraction, residence, and what stands still.

Lengths are in grain diameters d, times in tau = sqrt(d/g). Standard errors are over pairs of successive snapshots.
"""

import numpy as np

from .axial_flow import mean_of, residence_medians, speeds_at
from .passages import drained, falls, outflow, snapshots_of, within
from .standing import STILL, still_share

HEIGHTS = (5.0, 10.0, 15.0)  # d, of the profiles
LEVELS = (5.0, 10.0)  # d, from which residence is counted
STRIP = 2.0  # d, width of the strips of a profile
BULK = (5.0, 15.0)  # d, heights between which the packing fraction is counted
CORE = 6.0  # d from the middle of an outlet, where it is
RIDGE = 2.0  # d to both sides of the middle between two outlets, where the ridge is looked for


def measure(frames, scene, start, end):
    """Quantity -> [value, standard error].

    frames : Frames of a drainage in the order of time; scene : Scene of the box
    start, end : the interval, tau

    With one outlet profiles are along |x|, otherwise along x. Raises ValueError if fewer than three snapshots lie in
    the interval, or if they do not tell what leaves.
    """
    snapshots = snapshots_of(frames, scene)
    inside = within(snapshots, start, end)
    pairs = list(zip(inside, inside[1:]))
    found = {"outflow": mean_of(outflow(pairs))}
    outlets = scene.container().middles
    if len(outlets) > 1:
        found.update(_outflows(pairs, outlets))
    width, depth = scene.half_width_x / scene.diameter, 2 * scene.half_depth_y / scene.diameter
    for height in HEIGHTS:
        found.update(_profile(pairs, height, width, folded=len(outlets) == 1))
    found["packing_fraction"] = mean_of([_packing_fraction(s, outlets, depth) for s in inside])
    for level in LEVELS:
        found[f"residence_median_{level:g}d"] = mean_of(residence_medians(snapshots, level, start, end))
    found["still_share"] = [still_share(inside[0], inside[-1]), float("nan")]
    for low, high in zip(outlets, outlets[1:]):
        found[f"ridge_at_x{(low + high) / 2:g}d"] = [_ridge(inside[0], inside[-1], (low + high) / 2), float("nan")]
    return found


def _outflows(pairs, outlets):
    """Of each outlet: what leaves goes to the one whose middle was nearest before."""
    rates = []
    for before, after in pairs:
        nearest = np.abs(before.positions[:, :1] - np.array(outlets)).argmin(axis=1)
        rates.append(np.bincount(nearest, drained(before, after), minlength=len(outlets)) / (after.time - before.time))
    return {f"outflow_at_x{x:g}d": mean_of(np.array(rates)[:, k]) for k, x in enumerate(outlets)}


def _profile(pairs, height, width, folded):
    """Rate of fall in strips along x at a height."""
    strips = int((width if folded else 2 * width) / STRIP + 1e-6)
    edges = np.linspace(0.0 if folded else -width, width, strips + 1)
    speeds = np.array([speeds_at(*pair, height, edges, lambda x, y: np.abs(x) if folded else x) for pair in pairs])
    return {f"speed_{height:g}d_x{(low + high) / 2:.1f}d": mean_of(speeds[:, k]) for k, (low, high) in enumerate(zip(edges, edges[1:]))}


def _packing_fraction(snapshot, outlets, depth):
    """Grain volume by centres, over the outlets, from wall to wall or through the period in y."""
    x, _, z = snapshot.positions.T
    over = (np.abs(x[:, None] - np.array(outlets)) < CORE).sum(axis=1)
    count = over[(z > BULK[0]) & (z < BULK[1])].sum()
    return count * np.pi / 6 / (len(outlets) * 2 * CORE * depth * (BULK[1] - BULK[0]))


def _ridge(first, last, x):
    """How high the grains stand still over a place of the base: the lowest layer of 1 d that comes down by STILL on average."""
    middle, fall = falls(first, last)
    here = (np.abs(middle[:, 0] - x) < RIDGE) & (middle[:, 2] > 0)
    layer = (middle[here, 2] + fall[here] / 2).astype(int)  # by where grains were at first
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.bincount(layer, weights=fall[here]) / np.bincount(layer)
    moving = np.flatnonzero(mean > STILL)
    return float(moving[0]) if len(moving) else float("nan")
