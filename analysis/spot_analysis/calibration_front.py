# SPDX-License-Identifier: GPL-2.0-or-later
"""How fast the start of flow climbs: v_s read off another way, as a check; d and tau."""

from dataclasses import dataclass

import numpy as np

from .fits import fit_line
from .snapshot import LAG_TAU, TIME_TOLERANCE

FRONT_HEIGHTS = np.arange(10.0, 91.0, 10.0)


@dataclass(frozen=True)
class Front:
    """Arrival of half the outflow at (h,) heights, tau, and the speed of the line through them, d/tau."""

    heights: np.ndarray
    arrivals: np.ndarray
    speed: float
    error: float


def measure_front(tracks, outflow):
    """When half of ``outflow`` first passes each height, from the snapshots since the start; None where they are too few."""
    steps = np.diff(tracks.early_times)
    usable = int(np.argmax(np.abs(steps - LAG_TAU) > TIME_TOLERANCE)) or len(steps)
    if abs(tracks.early_times[0]) > TIME_TOLERANCE or usable < 5:
        return None
    above = np.array([[(z > level).sum() for level in FRONT_HEIGHTS] for z in tracks.early_heights[:usable + 1]])
    flux = -np.diff(above, axis=0) / steps[:usable, None]
    middles = (tracks.early_times[1:usable + 1] + tracks.early_times[:usable]) / 2
    arrivals = np.array([_first_passage(middles, column, outflow / 2) for column in flux.T])
    known = np.isfinite(arrivals)
    if known.sum() < 4:
        return None
    heights, times = FRONT_HEIGHTS[known], arrivals[known]
    slope, intercept = fit_line(heights, times)
    scatter = np.sqrt(((times - intercept - slope * heights)**2).sum() / (len(times) - 2)
                      / ((heights - heights.mean())**2).sum())
    return Front(heights, times, float(1 / slope), float(scatter / slope**2))


def _first_passage(times, values, level):
    """Time at which ``values`` first reach ``level``, between samples by a straight line."""
    reached = np.flatnonzero(values >= level)
    if not reached.size or reached[0] == 0:
        return np.nan
    after = reached[0]
    share = (level - values[after - 1]) / (values[after] - values[after - 1])
    return times[after - 1] + share * (times[after] - times[after - 1])
