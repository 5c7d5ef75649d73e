# SPDX-License-Identifier: GPL-2.0-or-later
"""A row of the numbers of a deck, and those whose range is what was compared with DEM."""

import math
from dataclasses import dataclass

ROUNDING = 1e-6  # of numbers that a deck has as text
LOOSE = 0.01  # of lengths over a d that is the mean of sizes written with few digits
OUTLETS = (6.5, 8.0, 15.0)  # d: from, to those of the calibrations, to the widest that was compared
SIZES = (0.825, 1.652)  # d: of examples/bidisperse
EQUAL = 1.0001  # largest diameter over the smallest, up to which grains are of one size


@dataclass(frozen=True)
class Row:
    """low, high : of the range, None where there is none; note : on the number or on the range; slack : share of bounds"""

    name: str
    value: float
    unit: str
    low: float = None
    high: float = None
    note: str = ""
    slack: float = ROUNDING

    @property
    def fits(self):
        """None where there is no range."""
        if self.low is None and self.high is None:
            return None
        low, high = (-math.inf if self.low is None else self.low), (math.inf if self.high is None else self.high)
        return low * (1 - self.slack) <= self.value <= high * (1 + self.slack)


def outlet(width):
    """width : d"""
    low, calibrated, high = OUTLETS
    note = "calibrations and DEM; below 6, DEM may clog"
    if calibrated * (1 + LOOSE) < width <= high * (1 + LOOSE):
        note = f"compared with DEM; calibrations have {low:g} to {calibrated:g}"
    return Row("narrowest outlet", width, "d", low, high, note, LOOSE)


def is_mixture(run):
    return run.get("largest", 1) > EQUAL * run.get("smallest", 1)  # which older programs don't tell


def sizes(run, d):
    if not is_mixture(run):
        return []
    ratio = run["largest"] / run["smallest"]
    return [Row("largest over smallest grain", ratio, "", None, 2, "two sizes, compared with DEM", LOOSE),
            Row("smallest grain", run["smallest"] / d, "d", SIZES[0], None, "examples/bidisperse", LOOSE),
            Row("largest grain", run["largest"] / d, "d", None, SIZES[1], "examples/bidisperse", LOOSE)]


def closures(run, d):
    """Of what makes beds of any density and width flow as DEM's: those that the program tells; 0 switches each off."""
    of_mixtures = "; of mixtures: examples/bidisperse" if is_mixture(run) else ""
    all_rows = {
        "critical": ("critical fraction phi_c", 1, "", "equal glass beads have 0.62" + of_mixtures, "beds flow as dense as they are"),
        "full_strain": ("strain of full exchange s_1", d, "1/d", "glass beads have 0.2", "plugs loosen as all else does"),
        "spread": ("spread by shear B", 1, "", "glass beads have 0.6", "beds sink as funnels, not as plugs")}
    return [Row(name, run[key] * unit, units, None, None, note if run[key] else f"0: off; {without}")
            for key, (name, unit, units, note, without) in all_rows.items() if key in run]
