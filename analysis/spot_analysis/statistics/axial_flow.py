# SPDX-License-Identifier: GPL-2.0-or-later
"""How grains flow in a hopper that is round about its axis: outflow, profiles of their fall, what stands still, packing
fraction,
residence and mixing.

Lengths are in grain diameters d, times in tau = sqrt(d/g). Standard errors are over pairs of successive snapshots.
"""

import numpy as np

from .axial_mixing import mixing
from .axial_packing import CORE_LAYER, core_radius, fractions_of_layers
from .passages import falls, outflow, residence_times, snapshots_of, within
from .standing import stagnant_layer, still_share

HEIGHTS = (5.0, 10.0, 15.0, 20.0)  # d, of the profiles
HALF_SLAB = 1.0  # d
RING = 2.0  # d, width of the rings of a profile
LEVELS = (5.0, 10.0)  # d, from which residence is counted
SHARES = {"p16": 0.16, "median": 0.5, "p84": 0.84}  # of the grains that leave, which stay less long


def mean_of(values):
    """[mean, standard error] of independent values; not a number where there are none."""
    values = np.asarray(values, dtype=float)
    values = values[np.isfinite(values)]
    if len(values) == 0:
        return [float("nan"), float("nan")]
    return [float(values.mean()), float(values.std(ddof=1) / np.sqrt(len(values))) if len(values) > 1 else float("nan")]


def measure(frames, scene, start, end):
    """Quantity -> [value, standard error].

    frames : Frames of a drainage in the order of time; scene : AxialScene
    start, end : the interval, tau

    Raises ValueError if fewer than three snapshots lie in the interval, or if they do not tell what leaves.
    """
    snapshots = snapshots_of(frames, scene)
    inside = within(snapshots, start, end)
    pairs = list(zip(inside, inside[1:]))
    found = {"outflow": mean_of(outflow(pairs))}
    for height in HEIGHTS:
        found.update(_profile(pairs, height, scene.radius_at(height)))
    found["packing_fraction"] = mean_of([_packing_fraction(s, scene) for s in inside])
    for level in LEVELS:
        found[f"residence_median_{level:g}d"] = mean_of(residence_medians(snapshots, level, start, end))
    found.update(_longer_and_shorter(snapshots, start, end))
    names = [*(f"volume_fraction_{height:g}d" for height in HEIGHTS), "volume_fraction_core"]
    found.update(zip(names, map(mean_of, np.transpose([fractions_of_layers(s, scene, HEIGHTS) for s in inside]))))
    for height in HEIGHTS:
        found[f"stagnant_layer_{height:g}d"] = stagnant_layer(pairs, height, float(scene.radius_at(height)))
    found["still_share"] = [still_share(inside[0], inside[-1]), float("nan")]
    opened = next(s for s in snapshots if s.time >= -1e-9)
    found.update({name: [index, float("nan")] for name, index in mixing(opened, inside[-1]).items()})
    return found


def _profile(pairs, height, radius):
    """Rate of fall in rings around the axis, at a height, and that at the wall over that on the axis (mass flow index)."""
    edges, speeds = speeds_in_rings(pairs, height, radius)
    name = f"speed_{height:g}d"
    found = {f"{name}_r{(low + high) / 2:.1f}d": mean_of(speeds[:, k]) for k, (low, high) in enumerate(zip(edges, edges[1:]))}
    with np.errstate(invalid="ignore", divide="ignore"):
        found[f"mass_flow_index_{height:g}d"] = mean_of(speeds[:, -1] / speeds[:, 0])
    return found


def speeds_in_rings(pairs, height, radius):
    """(edges, speeds) of rings around the axis, d, (rings + 1,), and d/tau, (pairs, rings); the last is wider, up to the wall."""
    edges = np.append(RING * np.arange(max(int(radius / RING + 1e-6), 1)), radius)
    return edges, np.array([speeds_at(*pair, height, edges, np.hypot) for pair in pairs])


def speeds_at(before, after, height, edges, place):
    """Mean fall (d/tau) of what is at a height, in bins of place(x, y); not a number in those without grains."""
    middle, fall = falls(before, after)
    slab = np.abs(middle[:, 2] - height) < HALF_SLAB
    at = place(middle[slab, 0], middle[slab, 1])
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.histogram(at, edges, weights=fall[slab] / (after.time - before.time))[0] / np.histogram(at, edges)[0]


def _packing_fraction(snapshot, scene):
    """Of the core of the cylinder, from its lower end upwards: grain volume by centres, as in references measured
    before."""
    low, core = scene.cone_height / scene.diameter, core_radius(scene)
    x, y, z = snapshot.positions.T
    count = np.count_nonzero((np.hypot(x, y) < core) & (z > low) & (z < low + CORE_LAYER))
    return count * np.pi / 6 / (np.pi * core ** 2 * CORE_LAYER)


def residence_medians(snapshots, level, start, end, share=0.5):
    """Medians, or another quantile, for each pair of snapshots in the interval, of the times that grains which leave
    then have taken
    from a level."""
    return [np.quantile(stayed, share) for before, after, _, stayed in residence_times(snapshots, level)
            if len(stayed) and start <= before.time and after.time <= end]


def _longer_and_shorter(snapshots, start, end):
    """Quantiles of the residence but for the median. Nobody can have stayed for longer than the run was when the
    interval began, so
    that longer ones are not known."""
    found = {}
    for level in LEVELS:
        for name, share in SHARES.items():
            if name != "median":
                value = mean_of(residence_medians(snapshots, level, start, end, share))
                known = value[0] <= start - max(snapshots[0].time, 0.0)
                found[f"residence_{name}_{level:g}d"] = value if known else [float("nan"), float("nan")]
    return found
