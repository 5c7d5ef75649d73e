# SPDX-License-Identifier: GPL-2.0-or-later
"""Boundary of the stagnant zone: how far from the axis grains move at a given height."""

import numpy as np

HEIGHTS = (5, 10, 20, 30)  # d
SHARE = 0.05  # of the velocity on the axis, below which grains count as stagnant
AXIS = 3.0  # d; the velocity on the axis is the mean over |x| < AXIS
MEANING = {"stagnant_boundary_*": "|x| where v_z falls to 5 % of the axis"}
NEEDS = {"*": ("height", "pairs")}


def boundary(counts, sums, edges):
    """|x| from which on outwards the mean downward velocity stays below SHARE of that on the axis, (...) d.

    counts, sums : (..., X) of ``flow.velocity_profile``, added over time; both sides are taken together

    Interpolated between the middles of the bins; not a number where all grains move, or none.
    """
    bins = counts.shape[-1] // 2
    near, far = slice(bins - 1, None, -1), slice(counts.shape[-1] - bins, None)
    grains, speeds = counts[..., near] + counts[..., far], sums[..., near] + sums[..., far]
    x = ((edges[1:] + edges[:-1]) / 2)[far]
    with np.errstate(invalid="ignore", divide="ignore"):
        velocity = speeds / grains
        axis = speeds[..., x < AXIS].sum(axis=-1) / grains[..., x < AXIS].sum(axis=-1)
        moving = velocity > SHARE * axis[..., None]
        last = bins - 1 - np.argmax(moving[..., ::-1], axis=-1)
        inner = np.minimum(last, bins - 2)
        here, beyond = (np.take_along_axis(velocity, (inner + k)[..., None], -1)[..., 0] for k in (0, 1))
        place = x[inner] + (here - SHARE * axis) / (here - beyond) * (x[1] - x[0])
    return np.where(moving.any(axis=-1) & (last < bins - 1) & (axis > 0), place, np.nan)


def quantities(view):
    run = view.run
    bins = len(run.profile_edges) - 1
    named = {}
    for height in HEIGHTS:
        index = np.searchsorted(run.profile_heights, height)
        columns = np.hstack([run.profile_counts[:, index], run.profile_sums[:, index]])
        named[f"stagnant_boundary_{height}d"] = view.estimate_pairs(
            "d", run.profile_start, run.profile_end, columns,
            lambda sums: boundary(sums[..., :bins], sums[..., bins:], run.profile_edges))
    return named


def boundaries(view):
    """Heights (h,) and the boundary at each of the stored profiles (h,)."""
    run = view.run
    rows = view.pair_rows(run.profile_start, run.profile_end)
    return run.profile_heights, boundary(run.profile_counts[rows].sum(axis=0), run.profile_sums[rows].sum(axis=0),
                                         run.profile_edges)
