# SPDX-License-Identifier: GPL-2.0-or-later
"""g(r) of a run over an interval, how far two of them are apart, and its signs of order at long times; lengths in d."""

import math

import numpy as np

from .neighbours import RDF_RANGE
from .value import Value

RDF_EDGES = np.linspace(0, RDF_RANGE, 201)
REBIN = 2  # stored bins in one of the 0.05 d that g(r) is compared in
CONTACT_PEAK = (0.95, 1.05)  # d; told apart, since its height depends on stiffness and bin width
MINIMUM_BETWEEN = (1.2, 1.6)  # d
ORDER_PEAKS = {"sqrt3": 3**0.5, "2": 2.0}  # d; grow as grains order (2006)
PEAK_HALF_WIDTH = 0.051  # d
MEANING = {
    "rdf_contact_peak": "g(r) in 0.95 d < r < 1.05 d",
    "rdf_first_minimum": "of g(r)",
    "rdf_at_sqrt3": "g(r) around sqrt(3) d; grows with order",
    "rdf_at_2": "g(r) around 2 d; grows with order",
    "rdf_l2_initial": "rms change of g(r) since the start, r > 1.05 d",
    "rdf_l2": "rms difference of g(r), spot and DEM",
    "rdf_l2_ratio": "rdf_l2 over DEM's rdf_l2_initial",
}
NEEDS = {"*": ("structure",)}


def rdf_counts(pairs, edges=RDF_EDGES):
    """Partners of the region's grains in each shell; (len(edges) - 1,) int64, summed over grains. Shells are even."""
    # numpy sorts the pairs when it is given edges or whole-number weights
    counts = np.histogram(pairs.distance, len(edges) - 1, (edges[0], edges[-1]), weights=pairs.ends.astype(float))[0]
    return np.rint(counts).astype(np.int64)


def slab_rdf(counts, grains, frames, region, container, edges=RDF_EDGES):
    """g(r) between two walls, or where the silo repeats.

    counts : (..., k) partners summed over grains and frames
    grains : (...) grains of the region summed over frames
    frames : (...) number of frames

    A grain placed evenly over a slab of thickness T expects 4 pi r^2 rho (1 - r/(2T)) partners per unit r for
    r <= T and 4 pi r^2 rho T/(2r) beyond (2010). T is the range of the centres, walls' distance less d, and rho
    the density over it: taking one from centres and the other from walls is off by d over the walls' distance.
    Grains stand in layers at the walls, not evenly, so g stays a few per cent below 1 for 3 d < r < T.
    Without walls T is infinite, and rho that of the period.
    """
    if container.periodic:
        density = np.asarray(grains, dtype=float) / np.asarray(frames, dtype=float) / (region.area() * container.period)
        expected = np.diff(4 * math.pi / 3 * np.asarray(edges)**3)
        return np.asarray(counts) / (np.asarray(grains, dtype=float) * density)[..., None] / expected
    thickness = 2 * container.half_depth - 1
    density = np.asarray(grains, dtype=float) / np.asarray(frames, dtype=float) / (region.area() * thickness)
    expected = np.diff(_ideal_partners(np.asarray(edges), thickness))
    return np.asarray(counts) / (np.asarray(grains, dtype=float) * density)[..., None] / expected


def _ideal_partners(r, thickness):
    """Integral from 0 to r of the expected count at unit density."""
    near = np.minimum(r, thickness)
    beyond = math.pi * thickness * (np.maximum(r, thickness)**2 - thickness**2)
    return 4 * math.pi * (near**3 / 3 - near**4 / (8 * thickness)) + beyond


def edges(run):
    return run.rdf_edges[::REBIN]


def middles(run):
    return (edges(run)[1:] + edges(run)[:-1]) / 2


def columns(run):
    """(T, bins + 2): partners in each bin, grains and frames; zero where the region is not full."""
    counts = run.rdf_counts.reshape(len(run.times), -1, REBIN).sum(axis=2)
    known = counts.sum(axis=1, keepdims=True) > 0
    return np.hstack([counts, run.region_grains[:, None] * known, known]).astype(float)


def rdf(run, sums):
    """g(r) from ``columns`` added up, (..., bins); not a number without data."""
    with np.errstate(invalid="ignore", divide="ignore"):
        return slab_rdf(sums[..., :-2], sums[..., -2], sums[..., -1], run.region(), run.scene.container(), edges(run))


def mean_rdf(view):
    """g(r) over the interval."""
    return rdf(view.run, columns(view.run)[view.snapshots].sum(axis=0))


def initial_rdf(view):
    return rdf(view.run, columns(view.run)[0])


def distance(run, one, other):
    """Root mean square of the difference of two g(r), (..., bins), beyond the contact peak."""
    beyond = edges(run)[:-1] > CONTACT_PEAK[1] - 1e-9
    return np.sqrt(((one - other)[..., beyond]**2).mean(axis=-1))


def mean_between(run, curve, low, high):
    """Mean of g(r) (..., bins) over the bins between low and high."""
    return curve[..., (edges(run)[:-1] > low - 1e-9) & (edges(run)[1:] < high + 1e-9)].mean(axis=-1)


def first_minimum(run, curve):
    """Place of the first minimum of g(r) (..., bins), d: of the parabola that fits it within MINIMUM_BETWEEN, which is
    wide enough for the scatter of the bins."""
    r = middles(run)
    near = (r > MINIMUM_BETWEEN[0]) & (r < MINIMUM_BETWEEN[1])
    base = np.vander(r[near] - 1.4, 3)
    a, b = (np.linalg.pinv(base) @ curve[..., near, None])[..., :2, 0].T
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(a > 0, 1.4 - b / (2 * a), np.nan).T


def quantities(view):
    run, initial = view.run, initial_rdf(view)
    samples = columns(run)

    def estimate(unit, statistic):
        return view.estimate(unit, run.times, samples, lambda sums: statistic(rdf(run, sums)))

    named = {"rdf_contact_peak": estimate("1", lambda g: mean_between(run, g, *CONTACT_PEAK)),
             "rdf_first_minimum": estimate("d", lambda g: first_minimum(run, g))}
    for name, place in ORDER_PEAKS.items():
        low, high = place - PEAK_HALF_WIDTH, place + PEAK_HALF_WIDTH
        named[f"rdf_at_{name}"] = estimate("1", lambda g, low=low, high=high: mean_between(run, g, low, high))
    named["rdf_l2_initial"] = estimate("1", lambda g: distance(run, g, initial))
    return named


def between(dem, spot):
    """What needs both runs."""
    apart = float(distance(dem.run, mean_rdf(dem), mean_rdf(spot)))
    change = float(distance(dem.run, mean_rdf(dem), initial_rdf(dem)))
    return {"rdf_l2": Value.of("1", apart), "rdf_l2_ratio": Value.of("1", apart / change if change else np.nan)}
