# SPDX-License-Identifier: GPL-2.0-or-later
"""What is judged: quantities by family, each in the windows of time that it is asked for.

A *window* is an interval that DEM and the spot model are seen over: "early", where the flow begins to be steady; "late", where it
has lasted; "end", where order has had the longest time to grow. Quantities through time have none.
"""

from dataclasses import dataclass

from ..statistics import through_time
from ..statistics.bootstrap import BLOCK_TAU, MINIMUM_BLOCKS
from ..statistics.interval import STEADY_FROM
from .bounds import FAMILIES, Bound
from .by_name import by_name

WINDOWS = {"early": (STEADY_FROM, 90.0), "late": (200.0, 304.0), "end": (250.0, 304.0)}  # tau
REPORTED = {"velocity": ("correlation_rms", "correlation_length")}  # family -> quantities without a bound


@dataclass(frozen=True)
class Criterion:
    """One row: a quantity of a family in a window, None for one through time; bound : None where it is reported only."""

    family: str
    name: str
    window: str
    bound: Bound

    @property
    def label(self):
        return self.name if self.window is None else f"{self.name}, {self.window}"


def _criteria():
    slices = [through_time.slice_name(quantity, span) for quantity in ("packing_fraction", "surface_angle")
              for span in through_time.SLICES]
    for family, bounds in FAMILIES.items():
        for pattern, bound in bounds.items():
            named = [name for name in slices if by_name({pattern: True}, name, False)]
            yield from (Criterion(family, name, None, bound) for name in named)
            if not named:
                windows = ("early",) if family == "front" else ("early", "end") if pattern == "crystal_share" else ("early", "late")
                yield from (Criterion(family, pattern, window, bound) for window in windows)
        yield from (Criterion(family, name, window, None) for name in REPORTED.get(family, ()) for window in ("early", "late"))


CRITERIA = tuple(_criteria())


def windows_of(last):
    """window -> (start, end), tau, of runs that end at ``last``: those of WINDOWS that leave enough time for a standard error."""
    spans = {name: (start, min(end, last)) for name, (start, end) in WINDOWS.items()}
    return {name: span for name, span in spans.items() if span[1] - span[0] >= MINIMUM_BLOCKS * BLOCK_TAU - 1e-9}
