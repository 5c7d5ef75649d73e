# SPDX-License-Identifier: GPL-2.0-or-later
"""R_s from C(r), the spatial correlation of velocity fluctuations along x."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from .calibration_estimate import CalibrationError, Estimate, combine, estimate
from .calibration_fits import fit_family

EDGES = np.linspace(1, 6, 21)  # d; no data below, none of the form beyond
TOUCHING = 1.5  # d; nearer grains push and roll off each other, in DEM and in relaxation, which no form holds
RADII = np.arange(1.2, 5.001, 0.1)
BETAS = np.arange(0.2, 12.001, 0.05)
GEOMETRY_PAIRS = 400  # in each bin
CUTS = 12  # Gauss points across the slab


@dataclass(frozen=True)
class Correlation:
    """C(r) and what was fitted to it from TOUCHING on.

    distance : (k,) d; curve : Estimate (k,); fitted : (k,) bool
    radius : R_s of A f(r; R_s) + B with the intersection form f between the walls, d
    amplitude, background : A and B
    bulk_radius : R_s with the form of a whole sphere instead
    decay : beta of alpha exp(-r/beta) (2006)
    form, exponential : (k,) the two fitted curves
    """

    distance: np.ndarray
    curve: Estimate
    fitted: np.ndarray
    radius: Estimate
    amplitude: Estimate
    background: Estimate
    bulk_radius: Estimate
    decay: Estimate
    form: np.ndarray
    exponential: np.ndarray


@dataclass(frozen=True)
class PairGeometry:
    """Pairs of each bin of EDGES and all grains, for the walls' cut: heights y of both, distance in the plane (x, z)."""

    first: np.ndarray  # (k, m)
    second: np.ndarray
    apart: np.ndarray
    grains: np.ndarray  # (n,)


def close_pairs(positions):
    """Indices and distances, (p,) each, of the pairs within the range of EDGES."""
    first, second = cKDTree(positions).query_pairs(EDGES[-1], output_type="ndarray").T
    return first, second, np.sqrt(((positions[first] - positions[second])**2).sum(axis=1))


def correlation_sums(positions, velocity):
    """Sums over the pairs of one region: (2 k + 2,) products and pairs in each bin of EDGES, squares and grains.

    positions : (n, 3) d; velocity : (n,)
    """
    first, second, distance = close_pairs(positions)
    products = np.histogram(distance, EDGES, weights=velocity[first] * velocity[second])[0]
    return np.concatenate([products, np.histogram(distance, EDGES)[0], [(velocity**2).sum(), len(velocity)]])


def normalised(sums):
    """C(r) = <u(0) u(r)> / <u^2> from ``correlation_sums`` added up; (..., 2 k + 2) to (..., k)."""
    bins = len(EDGES) - 1
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = sums[..., :bins] / sums[..., bins:2 * bins]
        return mean / (sums[..., -2] / sums[..., -1])[..., None]


def sphere_form(r, radius):
    """Share of a sphere that one of the same radius shares with it, centres r apart (2006): the form of C(r) in bulk."""
    share = r / (2 * radius)
    return np.where(share < 1, 1 - 1.5 * share + 0.5 * share**3, 0)


def pair_geometry(positions, seed=1):
    """PairGeometry of a sample of the pairs of one region; raises CalibrationError where a bin has none."""
    first, second, distance = close_pairs(positions)
    bins = np.digitize(distance, EDGES) - 1
    rng = np.random.default_rng(seed)
    if not np.isin(np.arange(len(EDGES) - 1), bins).all():
        raise CalibrationError(f"no pairs of grains at some distances between {EDGES[0]:g} and {EDGES[-1]:g} d: no C(r)")
    chosen = np.array([rng.choice(np.flatnonzero(bins == number), GEOMETRY_PAIRS) for number in range(len(EDGES) - 1)])
    one, other = positions[first[chosen]], positions[second[chosen]]
    return PairGeometry(one[..., 1], other[..., 1], np.hypot(one[..., 0] - other[..., 0], one[..., 2] - other[..., 2]),
                        positions[:, 1])


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
    return shared.mean(axis=1) / (np.pi * disc(geometry.grains)**2 @ weights).mean()


def _lens(one, other, apart):
    """Area that two discs of the radii ``one`` and ``other``, centres ``apart``, have in common."""
    with np.errstate(invalid="ignore", divide="ignore"):
        along = (apart**2 + one**2 - other**2) / (2 * apart)
        back = apart - along
        area = (one**2 * np.arccos((along / one).clip(-1, 1)) - along * np.sqrt(np.maximum(one**2 - along**2, 0))
                + other**2 * np.arccos((back / other).clip(-1, 1)) - back * np.sqrt(np.maximum(other**2 - back**2, 0)))
    area = np.where(apart >= one + other, 0, area)
    return np.where(apart <= np.abs(one - other), np.pi * np.minimum(one, other)**2, area)


def measure_correlation(tracks, fluctuations, core, buffer, progress):
    """Correlation from every step; raises CalibrationError where C(r) has no shape that gives R_s."""
    region = core.upper()
    samples = []
    for number, (middle, residual) in enumerate(zip(fluctuations.middle, fluctuations.residual), 1):
        inside = region.contains(middle)
        if inside.sum() < 100:
            raise CalibrationError(f"only {inside.sum()} grains in |x| < {region.half_width:g} d, {region.bottom:g} d < z "
                                   f"< {region.top:g} d at {tracks.step_times[number - 1]:g} tau: C(r) needs 100")
        samples.append(correlation_sums(middle[inside], residual[inside]))
        progress(f"C(r): {number} of {len(fluctuations.middle)} steps")
    return fit_correlation(tracks.step_times, np.array(samples), tracks.span, pair_geometry(middle[inside]),
                           tracks.container.half_depth - buffer)


def fit_correlation(times, samples, span, geometry, reach):
    """Correlation from ``correlation_sums`` of each step, (T, 2 k + 2).

    The background is what moves together over more than the range: the column of grains sways as a whole. It is the same
    for both programs, and without it a sway reads as a large radius.
    """
    distance = (EDGES[1:] + EDGES[:-1]) / 2
    fitted = distance > TOUCHING
    tables = {"walled": np.array([walled_form(geometry, radius, reach) for radius in RADII]),
              "bulk": np.array([sphere_form(distance, radius) for radius in RADII])}

    def with_background(curves):
        form = curves[:, fitted]
        centred = form - form.mean(axis=1, keepdims=True)

        def statistic(values):
            values = values[..., fitted]
            radius, amplitude = fit_family(values - values.mean(axis=-1, keepdims=True), centred, RADII)
            return np.stack([radius, amplitude, values.mean(axis=-1)
                             - amplitude * np.interp(radius, RADII, form.mean(axis=1))], axis=-1)
        return combine(statistic, curve)

    curve = estimate(times, samples, span, normalised)
    exponentials = np.exp(-distance[fitted] / BETAS[:, None])
    decay = combine(lambda values: np.stack(fit_family(values[..., fitted], exponentials, BETAS), axis=-1), curve)
    walled, bulk = with_background(tables["walled"]), with_background(tables["bulk"])
    radius, amplitude, background = (walled[index] for index in range(3))
    if not radius.is_determined() or not amplitude.is_determined():
        raise CalibrationError(f"C(r) between {TOUCHING:g} and {EDGES[-1]:g} d has no shape that gives R_s between "
                               f"{RADII[0]:g} and {RADII[-1]:g} d (it is {curve.value[fitted][0]:.2f} at "
                               f"{distance[fitted][0]:.2f} d, {curve.value[-1]:.2f} at {distance[-1]:.2f} d)")
    form = background.value + amplitude.value * walled_form(geometry, radius.value, reach)
    return Correlation(distance, curve, fitted, radius, amplitude, background, bulk[0], decay[0], form,
                       decay.value[1] * np.exp(-distance / decay.value[0]))
