# SPDX-License-Identifier: GPL-2.0-or-later
"""How a round container drains to its end: grains that are left, its surface along r, and the heap that stays.

Lengths are in grain diameters d, times in tau = sqrt(d/g). What is known of one moment has no standard error.
"""

import math

import numpy as np

from .axial_flow import mean_of
from .fits import fit_line
from .passages import common, drained, snapshots_of

RING = 1.0  # d, width of the rings of a profile
COLUMN = 2.0  # d, along a ring, of the columns whose highest grains are the surface
FILLED = 2 / 3  # of a ring's columns: with fewer, the surface is not known there
LOWEST = 1.0  # d above the base, of a ring that counts for the angle: lower ones are single grains
FROM_WALL = 1.0  # d, of rings that don't count
FEWEST = 3  # rings of an angle
ENDS = 0.99  # of what leaves at all has left when the flow is over
LEFT_EVERY = 10.0  # tau, of the grains that are left
PROFILES = (20.0, 40.0, 60.0)  # tau, of the surface
AFTER = 20.0  # tau, in which a heap may creep, at the end


def surface(positions, radius):
    """The free surface of one moment: middles of rings (n,), mean height of the highest centres of their columns (n,); not a number
    where a ring has too few grains.

    positions : (m, 3) of grains over the outlet; radius : of the container
    """
    edges = np.append(np.arange(0.0, radius - 0.5 * RING, RING), radius)
    at, turn = np.hypot(positions[:, 0], positions[:, 1]), np.arctan2(positions[:, 1], positions[:, 0]) / (2 * math.pi) % 1.0
    ring = np.searchsorted(edges, at, side="right") - 1
    middles, heights = (edges[1:] + edges[:-1]) / 2, np.full(len(edges) - 1, np.nan)
    for k, middle in enumerate(middles):
        columns = max(1, round(2 * math.pi * middle / COLUMN))
        here = ring == k
        highest = np.full(columns, -np.inf)
        np.maximum.at(highest, (turn[here] * columns).astype(int) % columns, positions[here, 2])
        known = np.isfinite(highest)
        if known.mean() >= FILLED:
            heights[k] = highest[known].mean()
    return middles, heights


def heap_angle(middles, heights, scene):
    """Angle of the surface with the horizontal, degrees, by a straight line through what lies over base or cone and off the wall, and
    its standard error; not a number where less than three rings do."""
    rim, radius, base = in_d(scene)
    over = np.where(middles > rim, (middles - rim) * base / (radius - rim), np.inf)
    with np.errstate(invalid="ignore"):
        good = (heights - over > LOWEST) & (middles < radius - FROM_WALL)
    if good.sum() < FEWEST:
        return [math.nan, math.nan]
    r, h = middles[good], heights[good]
    slope, start = fit_line(r, h)
    spread = math.sqrt(((h - start - slope * r) ** 2).sum() / (len(r) - 2) / ((r - r.mean()) ** 2).sum())
    return [math.degrees(math.atan(slope)), math.degrees(spread / (1 + slope ** 2))]


def in_d(scene):
    """Radii of the outlet and of the cylinder, height of the cone (0 over a flat base), in d."""
    return tuple(length / scene.diameter for length in (scene.orifice_radius, scene.cylinder_radius, scene.cone_height))


def over_after(times, counts):
    """When ``ENDS`` of what leaves at all has left, linearly between snapshots; counts (n,) do not grow."""
    gone = counts[0] - np.asarray(counts, dtype=float)
    return float(np.interp(ENDS * gone[-1], gone, times)) if gone[-1] > 0 else math.nan


def crept(before, after):
    """Median way of the grains that are over the outlet in both snapshots, d; not a number where there are none."""
    first, second = common(before, after)
    ways = np.linalg.norm(before.positions[first] - after.positions[second], axis=1)[after.positions[second, 2] > 0]
    return float(np.median(ways)) if len(ways) else math.nan


def measure(frames, scene, start, end):
    """Quantity -> [value, standard error].

    frames : Frames of a drainage to its end in the order of time; scene : AxialScene
    start, end : the interval in which the outflow is taken, tau

    Raises ValueError if the drainage ends before the interval does, or is shorter than 20 tau.
    """
    runs = snapshots_of(frames, scene)
    times = np.array([one.time for one in runs])
    if len(runs) < 3 or times[-1] < max(end, AFTER) - 1e-9:
        raise ValueError(f"the drainage ends at {times[-1] if len(runs) else 0:g} tau, {max(end, AFTER):g} are needed")
    counts = np.array([np.count_nonzero(one.positions[:, 2] > 0) for one in runs])
    inside = [one for one in runs if start - 1e-9 <= one.time <= end + 1e-9]
    found = {"outflow": mean_of([drained(a, b).sum() / (b.time - a.time) for a, b in zip(inside, inside[1:])])}
    for time in np.arange(0.0, times[-1] + 1e-9, LEFT_EVERY):
        found[f"left_{time:g}tau"] = [float(np.interp(time, times, counts)), math.nan]
    found["left_end"] = [float(counts[-1]), math.nan]
    found["over_after"] = [over_after(times, counts), math.nan]
    calm = runs[int(np.argmin(np.abs(times - (times[-1] - AFTER))))]
    found["left_in_last_20tau"] = [float(drained(calm, runs[-1]).sum()), math.nan]
    found["crept_in_last_20tau"] = [crept(calm, runs[-1]), math.nan]
    for time in PROFILES:
        if time <= times[-1] + 1e-9:
            found.update(_surface_of(runs[int(np.argmin(np.abs(times - time)))], scene, f"{time:g}tau"))
    found.update(_surface_of(runs[-1], scene, "end"))
    return found


def _surface_of(snapshot, scene, name):
    middles, heights = surface(snapshot.positions[snapshot.positions[:, 2] > 0], in_d(scene)[1])
    found = {f"angle_{name}": heap_angle(middles, heights, scene)}
    found.update({f"surface_{name}_r{r:.1f}d": [float(height), math.nan] for r, height in zip(middles, heights)})
    return found
