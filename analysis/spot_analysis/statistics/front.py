# SPDX-License-Identifier: GPL-2.0-or-later
"""The front of the flow, which climbs after the orifice opens: when half the final flux has reached a height."""

import math

import numpy as np

from .value import Value

HEIGHTS = (30, 60, 90)  # d
FIRST = 1.0  # tau; a first snapshot after it may be after the front
COVER = 5  # d of packing that must be left above a height
MEANING = {"arrival_*": "half the final flux reaches that height"}
NEEDS = {"*": ("start", "steady", "end")}


def arrival(times, above, final):
    """When the flux through a level first exceeds half of ``final``, tau, and the slope of the flux there, 1/tau^2.

    times (n,); above (n,) grains above the level. Fluxes belong to the middle between two snapshots and are
    interpolated; the times must reach back to before the front. Not a number where half is never reached.
    """
    flux = -np.diff(above) / np.diff(times)
    middle = (times[1:] + times[:-1]) / 2
    reached = np.flatnonzero(flux >= final / 2)
    if not len(reached) or not final > 0:
        return math.nan, math.nan
    after = reached[0]
    before = (0.0, times[0]) if after == 0 else (flux[after - 1], middle[after - 1])
    slope = (flux[after] - before[0]) / (middle[after] - before[1])
    return before[1] + (final / 2 - before[0]) / slope, slope


def quantities(view):
    """The standard error is that of the flux at the crossing over its slope: fluxes over one pair of snapshots scatter
    about their mean in the interval, and half the flux by 1/sqrt(2) as much."""
    run, named = view.run, {}
    times = run.times[view.common]
    for height in HEIGHTS:
        name, final = f"arrival_{height}d", view.flux(height)
        named[name] = Value("tau")
        # no front was seen, no final flux, or the surface has come down to the height
        covered = run.count_above(height + COVER)[view.snapshots[-1]] > 0
        if final.value is None or times[0] > FIRST or not view.interval.is_steady() or not covered:
            continue
        when, slope = arrival(times, run.count_above(height)[view.common], final.value)
        sampled = run.times[view.snapshots]
        scatter = np.std(-np.diff(run.count_above(height)[view.snapshots]) / np.diff(sampled))
        named[name] = Value.of("tau", when, scatter / math.sqrt(2) / slope if final.error is not None else None)
    return named
