# SPDX-License-Identifier: GPL-2.0-or-later
"""R_s from ``velocity_correlation``: the form that spots between walls give C(r), and its fit."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from ..statistics import velocity_correlation
from ..statistics.mean_flow import core
from ..statistics.velocity_correlation import BOTTOM, EDGES, TOP
from .estimate import CalibrationError, Estimate, combine
from .fits import fit_family
from .view import estimate_pairs, require_cover

TOUCHING = 1.5  # d; nearer grains push and roll off each other, in DEM and in relaxation, which no form holds
RADII = np.arange(1.2, 5.001, 0.1)
GEOMETRY_POINTS = 1500
GEOMETRY_PAIRS = 400  # in each bin
CUTS = 12  # Gauss points across the slab


@dataclass(frozen=True)
class Correlation:
    """C(r) in the bins of velocity_correlation.EDGES, and what was fitted to it.

    distance : (k,) d; curve : Estimate (k,)
    radius : R_s of A f(r; R_s) + B with the intersection form f between the walls, from TOUCHING on, d
    amplitude, background : A and B
    decay : Estimate (2,), alpha and beta of alpha exp(-r/beta) (2006)
    form : (k,) the fitted form
    """

    distance: np.ndarray
    curve: Estimate
    radius: Estimate
    amplitude: Estimate
    background: Estimate
    decay: Estimate
    form: np.ndarray


@dataclass(frozen=True)
class PairGeometry:
    """Pairs of points of each bin of EDGES and all points, for the walls' cut: heights y of both, distance in the plane
    (x, z)."""

    first: np.ndarray  # (k, m)
    second: np.ndarray
    apart: np.ndarray
    points: np.ndarray  # (n,)


def pair_geometry(region, seed=1):
    """PairGeometry of points at random in ``region``."""
    rng = np.random.default_rng(seed)
    extent = np.array([region.half_width, region.half_depth, (region.top - region.bottom) / 2])
    points = rng.uniform(-extent, extent, (GEOMETRY_POINTS, 3))
    first, second = cKDTree(points).query_pairs(EDGES[-1], output_type="ndarray").T
    bins = np.digitize(np.linalg.norm(points[first] - points[second], axis=1), EDGES) - 1
    chosen = np.array([rng.choice(np.flatnonzero(bins == number), GEOMETRY_PAIRS) for number in range(len(EDGES) - 1)])
    one, other = points[first[chosen]], points[second[chosen]]
    return PairGeometry(one[..., 1], other[..., 1], np.hypot(one[..., 0] - other[..., 0], one[..., 2] - other[..., 2]),
                        points[:, 1])


def walled_form(geometry, radius, reach):
    """The form of C(r) between two walls, (k,), where the centres of spots are even in |y| < reach.

    A spot moves both grains of a pair while its centre is within R_s of both: the intersection of two spheres with the
    slab, cut into lenses at the heights of a Gauss rule. Over the same for one grain.
    """
    nodes, weights = np.polynomial.legendre.leggauss(CUTS)
    y = reach * nodes

    def disc(centres):
        return np.sqrt(np.maximum(radius**2 - (y - centres[..., None])**2, 0))

    shared = _lens(disc(geometry.first), disc(geometry.second), geometry.apart[..., None]) @ weights
    return shared.mean(axis=1) / (np.pi * disc(geometry.points)**2 @ weights).mean()


def _lens(one, other, apart):
    """Area that two discs of the radii ``one`` and ``other``, centres ``apart``, have in common."""
    with np.errstate(invalid="ignore", divide="ignore"):
        along = (apart**2 + one**2 - other**2) / (2 * apart)
        back = apart - along
        area = (one**2 * np.arccos((along / one).clip(-1, 1)) - along * np.sqrt(np.maximum(one**2 - along**2, 0))
                + other**2 * np.arccos((back / other).clip(-1, 1)) - back * np.sqrt(np.maximum(other**2 - back**2, 0)))
    area = np.where(apart >= one + other, 0, area)
    return np.where(apart <= np.abs(one - other), np.pi * np.minimum(one, other)**2, area)


def measure_correlation(view, buffer):
    """Correlation of the view; raises CalibrationError where C(r) has no shape that gives R_s.

    buffer : distance of spot centres from the walls, d
    """
    part = view.run.measured[velocity_correlation.NAME]
    require_cover(view, part.start, part.end, TOP)
    curve = estimate_pairs(view, part.start, part.end, velocity_correlation.columns(part), velocity_correlation.correlation)
    container = view.run.scene.container()
    return fit_correlation(curve, pair_geometry(core(container, BOTTOM, TOP)), container.half_depth - buffer)


def fit_correlation(curve, geometry, reach):
    """Correlation from C(r), an Estimate (k,).

    The background is what moves together over more than the range: the column of grains sways as a whole. It is the same
    for both programs, and without it a sway reads as a large radius.
    """
    distance = velocity_correlation.middles()
    fitted = distance > TOUCHING
    form = np.array([walled_form(geometry, radius, reach) for radius in RADII])[:, fitted]
    centred = form - form.mean(axis=1, keepdims=True)

    def statistic(values):
        values = values[..., fitted]
        radius, amplitude = fit_family(values - values.mean(axis=-1, keepdims=True), centred, RADII)
        return np.stack([radius, amplitude, values.mean(axis=-1)
                         - amplitude * np.interp(radius, RADII, form.mean(axis=1))], axis=-1)

    walled = combine(statistic, curve)
    radius, amplitude, background = (walled[index] for index in range(3))
    if not radius.is_determined() or not amplitude.is_determined():
        raise CalibrationError(f"C(r) between {TOUCHING:g} and {EDGES[-1]:g} d has no shape that gives R_s between "
                               f"{RADII[0]:g} and {RADII[-1]:g} d (it is {curve.value[fitted][0]:.2f} at "
                               f"{distance[fitted][0]:.2f} d, {curve.value[-1]:.2f} at {distance[-1]:.2f} d)")
    decay = combine(lambda values: np.stack(velocity_correlation.fit(values), axis=-1), curve)
    return Correlation(distance, curve, radius, amplitude, background, decay,
                       background.value + amplitude.value * walled_form(geometry, radius.value, reach))
