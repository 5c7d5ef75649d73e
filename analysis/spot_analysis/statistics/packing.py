# SPDX-License-Identifier: GPL-2.0-or-later
"""Packing fraction, contacts and overlaps in the structure region."""

import math

import numpy as np

from .structure import packing_fraction
from .value import Value

MEANING = {
    "packing_fraction": "in the structure region",
    "contacts_per_grain": "grains that overlap a grain there",
    "badness": "sum of squared overlaps a grain there",
    "badness_ratio": "spot over DEM",
    "largest_overlap_region": "there, mean over snapshots",
    "largest_overlap": "anywhere above z = 0",
    "largest_wall_overlap": "of a grain with walls or base",
}
NEEDS = {"*": ("grains", "structure")}


def fractions(run):
    """(T,) packing fraction; not a number where the region is not full."""
    fraction = packing_fraction(run.region_grains, run.region(), run.scene.container())
    return np.where(np.isfinite(run.badness), fraction, math.nan)


def quantities(view):
    run = view.run
    return {
        "packing_fraction": view.mean("1", fractions(run)),
        "contacts_per_grain": view.mean("1", run.contacts),
        "badness": view.mean("1", run.badness),
        "largest_overlap_region": view.mean("d", run.region_largest_overlap),
        "largest_overlap": _largest(view, run.largest_overlap),
        "largest_wall_overlap": _largest(view, run.largest_wall_overlap),
    }


def _largest(view, overlaps):
    """The largest of ``overlaps`` (T,) in the interval, unknown where no snapshot has a grain."""
    measured = view.snapshots[view.run.grains[view.snapshots] > 0]
    return Value("d", float(overlaps[measured].max()) if len(measured) else None)


def between(dem, spot):
    """B of the spot model over that of DEM, the only way in which published values of B compare."""
    one, other = (view.mean("1", view.run.badness) for view in (dem, spot))
    if one.value is None or other.value is None or one.value == 0:
        return {"badness_ratio": Value("1")}
    ratio = other.value / one.value
    known = one.error is not None and other.error is not None
    error = math.hypot(other.error, ratio * one.error) / one.value if known else None
    return {"badness_ratio": Value("1", ratio, error)}
