# SPDX-License-Identifier: GPL-2.0-or-later
"""The interval of time that is looked at, chosen from the snapshots that two runs have in common."""

import math
from dataclasses import dataclass

import numpy as np

from ..base.errors import AnalysisError
from .bootstrap import BLOCK_TAU, MINIMUM_BLOCKS
from .snapshot import TIME_TOLERANCE

STEADY_FROM = 40.0  # tau; from here the DEM reference is steady below z = 70 d


@dataclass(frozen=True)
class Interval:
    """start, end in tau; kind: "steady", "everything" or "chosen"."""

    start: float
    end: float
    kind: str

    @property
    def span(self):
        return self.start, self.end

    def is_steady(self):
        return self.kind == "steady" or self.start >= STEADY_FROM - TIME_TOLERANCE

    def holds(self, times):
        return (times >= self.start - TIME_TOLERANCE) & (times <= self.end + TIME_TOLERANCE)


def common_times(dem, spot):
    """Indices of the snapshots of both runs at the same times, (n,) and (n,).

    Raises AnalysisError where the two hold different scenes or share fewer than two times.
    """
    one, other = dem.scene.container(), spot.scene.container()
    for name in ("half_width", "half_depth", "orifice_radius"):
        if not math.isclose(getattr(one, name), getattr(other, name), rel_tol=1e-3):
            raise AnalysisError(f"the two runs have different containers: {name} is {getattr(one, name):g} d in DEM, "
                                f"{getattr(other, name):g} d in spot")
    if one.periodic != other.periodic:
        raise AnalysisError(f"the two runs have different containers: along y {'DEM' if one.periodic else 'spot'} is periodic, and "
                            "the other has walls")
    nearest = np.abs(dem.times[:, None] - spot.times).argmin(axis=1)
    matched = np.flatnonzero(np.abs(dem.times - spot.times[nearest]) <= TIME_TOLERANCE)
    if len(matched) < 2:
        raise AnalysisError(f"DEM has snapshots at {_list_times(dem.times)} and spot at {_list_times(spot.times)}: "
                            "fewer than two times are common")
    return matched, nearest[matched]


def _list_times(times):
    shown = [f"{time:g}" for time in times]
    return ", ".join(shown if len(shown) <= 5 else [*shown[:4], "...", shown[-1]]) + " tau"


def choose_interval(times, start=None, end=None):
    """The interval to compare, from the common times.

    Without ``start`` the steady part, from STEADY_FROM on, if it is long enough for a standard error, else
    everything. Raises AnalysisError where fewer than two common times lie inside.
    """
    last = times[-1] if end is None else end
    if start is not None:
        kind = "chosen"
    elif last - STEADY_FROM >= MINIMUM_BLOCKS * BLOCK_TAU:
        start, kind = STEADY_FROM, "steady"
    else:
        start, kind = times[0], "everything" if end is None else "chosen"
    inside = times[(times >= start - TIME_TOLERANCE) & (times <= last + TIME_TOLERANCE)]
    if len(inside) < 2:
        raise AnalysisError(f"fewer than two common snapshots between {start:g} and {last:g} tau "
                            f"(common times: {_list_times(times)})")
    return Interval(float(inside[0]), float(inside[-1]), kind)
