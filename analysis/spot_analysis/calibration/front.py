# SPDX-License-Identifier: GPL-2.0-or-later
"""How fast the start of flow climbs: v_s read off another way, as a check; d and tau."""

from dataclasses import dataclass

import numpy as np

from ..statistics.fits import fit_line
from ..statistics.front import arrival
from ..statistics.snapshot import LAG_TAU, TIME_TOLERANCE

FRONT_HEIGHTS = np.arange(10.0, 91.0, 10.0)


@dataclass(frozen=True)
class Front:
    """Arrival of half the outflow at (h,) heights, tau, and the speed of the line through them, d/tau."""

    heights: np.ndarray
    arrivals: np.ndarray
    speed: float
    error: float


def measure_front(run, outflow):
    """When half of ``outflow`` first passes each height, from the snapshots since the start; None where they are too few."""
    steps = np.diff(run.times)
    usable = int(np.argmax(np.abs(steps - LAG_TAU) > TIME_TOLERANCE)) or len(steps)
    if usable < 5:
        return None
    early = slice(usable + 1)
    arrivals = np.array([arrival(run.times[early], run.count_above(level)[early], outflow)[0] for level in FRONT_HEIGHTS])
    known = np.isfinite(arrivals)
    if known.sum() < 4:
        return None
    heights, times = FRONT_HEIGHTS[known], arrivals[known]
    slope, intercept = fit_line(heights, times)
    scatter = np.sqrt(((times - intercept - slope * heights)**2).sum() / (len(times) - 2)
                      / ((heights - heights.mean())**2).sum())
    return Front(heights, times, float(1 / slope), float(scatter / slope**2))
