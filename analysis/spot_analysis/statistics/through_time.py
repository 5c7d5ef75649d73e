# SPDX-License-Identifier: GPL-2.0-or-later
"""Packing fraction and angle of the surface in successive slices of time, to the end of the run: does a flow stay what it is?"""

import numpy as np

from . import bond_order, free_surface, radial_distribution
from .interval import Interval
from .interval_view import IntervalView
from .packing import fractions
from .snapshot import TIME_TOLERANCE

EDGES = (*range(20, 300, 20), 304)  # tau; the last slice goes on to where the DEM reference ends
SLICES = tuple(zip(EDGES, EDGES[1:]))
MEANING = {
    "packing_fraction_*tau": "in the structure region, mean of that time",
    "surface_angle_*tau": "of the free surface, mean of that time",
}
NEEDS = {"packing_*": ("reach", "structure"), "*": ("reach", "grains")}


def slice_name(quantity, span):
    return f"{quantity}_{span[0]:g}_{span[1]:g}tau"


def quantities(view):
    """Of the slices that the common times reach; both ends belong to a slice."""
    run, times = view.run, view.run.times[view.common]
    surface = run.measured[free_surface.NAME]
    angles = free_surface.angle(surface.x, surface.heights) if hasattr(surface, "x") else None
    named = {}
    for span in SLICES:
        if times[0] > span[0] + TIME_TOLERANCE or times[-1] < span[1] - TIME_TOLERANCE:
            continue
        part = IntervalView(run, view.common, Interval(*map(float, span), "chosen"))
        named[slice_name("packing_fraction", span)] = part.mean("1", fractions(run))
        if angles is not None:
            named[slice_name("surface_angle", span)] = part.mean_of("deg", surface.times, angles)
    return named


def series(view):
    """name -> times (n,) and samples (n,) at the common times: what a report shows to the end of the run."""
    run, common = view.run, view.common
    surface, order = (run.measured[concept.NAME] for concept in (free_surface, bond_order))
    place, half_width = radial_distribution.ORDER_PEAKS["sqrt3"], radial_distribution.PEAK_HALF_WIDTH
    curves = radial_distribution.rdf(run, radial_distribution.columns(run))
    samples = {"packing_fraction": (run.times, fractions(run)), "crystal_share": (order.times, order.share),
               "rdf_at_sqrt3": (run.times, radial_distribution.mean_between(run, curves, place - half_width, place + half_width)),
               "surface_angle": (surface.times, free_surface.angle(surface.x, surface.heights))}
    shared = {name: np.isin(times, run.times[common]) for name, (times, _) in samples.items()}
    return {name: (times[shared[name]], values[shared[name]]) for name, (times, values) in samples.items()}
