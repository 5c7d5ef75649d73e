# SPDX-License-Identifier: GPL-2.0-or-later
"""b_s from the width of the v_z profile, which grows with height as spots spread."""

from dataclasses import dataclass

import numpy as np

from .calibration_estimate import CalibrationError, Estimate, combine, estimate
from .calibration_fits import fit_family
from .fits import fit_line

HEIGHTS = np.arange(10.0, 51.0, 5.0)  # d, middles of slices
SLICE = 5.0  # d, their thickness
VARIANCES = np.arange(5.0, 600.0, 1.0)  # d^2
FINE = 10  # points a bin for the walled form
# What is called the variance of a profile: a fitted Gaussian's (2006); its second moment; and the same two of the spots
# between the walls that would give this profile, since walls turn a Gaussian's tails back. A DEM profile is flatter on
# top than any of these curves, which fits feel more than moments do.
METHODS = ("gaussian", "moment", "walled_gaussian", "walled_moment")
IMAGES = 3  # reflections on each side; with 24 d to the wall they hold up to a variance of 2000 d^2


@dataclass(frozen=True)
class Spreading:
    """Profiles at H heights in X bins, and the variances fitted to them.

    heights : (H,) d; centres : (X,) d
    profiles : Estimate (H, X), downward velocity, d/tau
    fitted : (H, X), the walled form
    variances : name -> Estimate (H,), d^2, by each of METHODS
    lines : name -> Estimate (2,), slope and intercept of variance against height
    method : one of METHODS; diffusion : Estimate, b_s = slope / 2 by it, d
    """

    heights: np.ndarray
    centres: np.ndarray
    profiles: Estimate
    fitted: np.ndarray
    variances: dict
    lines: dict
    method: str
    diffusion: Estimate


def profile_edges(container, buffer):
    """Bins 1 d wide out to the places spot centres keep to, where the walls begin to cut influence off."""
    reach = np.floor(container.half_width - buffer)
    return np.linspace(-reach, reach, int(2 * reach) + 1)


def profile_sums(middle, drop, duration, heights, edges):
    """(2 H X,) grains and sums of downward velocity in the slices about ``heights``.

    middle : (n, 3), drop : (n,) d over ``duration`` tau
    """
    counts, sums = [], []
    for height in heights:
        inside = np.abs(middle[:, 2] - height) < SLICE / 2
        x = middle[inside, 0]
        counts.append(np.histogram(x, edges)[0])
        sums.append(np.histogram(x, edges, weights=drop[inside] / duration)[0])
    return np.concatenate([np.ravel(counts), np.ravel(sums)])


def walled_profiles(edges, variances, half_width, buffer, radius):
    """v_z across x, (p, X), of spots spread to each of ``variances``, between walls.

    Spots between reflecting walls at half_width - buffer are a Gaussian with its images; each moves the grains
    within ``radius``, which smooths it with the sphere's section pi (R^2 - x^2). The variance is that of the spots.
    """
    reach = half_width - buffer
    step = (edges[1] - edges[0]) / FINE
    x = np.arange(-half_width + step / 2, half_width, step)
    shifts = 2 * reach * np.arange(-IMAGES, IMAGES + 1)
    signs = 1 - 2 * (np.arange(-IMAGES, IMAGES + 1) % 2)
    places = signs[:, None] * x + shifts[:, None]
    density = np.exp(-places**2 / (2 * np.asarray(variances)[:, None, None])).sum(axis=1)
    density[:, np.abs(x) > reach] = 0
    across = np.arange(-int(radius / step), int(radius / step) + 1) * step
    kernel = radius**2 - across**2
    smooth = np.array([np.convolve(row, kernel / kernel.sum(), mode="same") for row in density])
    bins = np.floor((x - edges[0]) / (edges[1] - edges[0])).astype(int)
    kept = (bins >= 0) & (bins < len(edges) - 1)
    binned = np.zeros((len(variances), len(edges) - 1))
    np.add.at(binned.T, bins[kept], smooth[:, kept].T)
    return binned / FINE


def measure_spreading(tracks, radius, buffer, top, method):
    """Spreading from every step, in slices that end below ``top``; ``method``, one of METHODS, gives b_s."""
    heights = HEIGHTS[HEIGHTS + SLICE / 2 <= top + 1e-9]
    edges = profile_edges(tracks.container, buffer)
    samples = []
    for start, end, duration in zip(tracks.positions, tracks.positions[1:], np.diff(tracks.times)):
        present = np.isfinite(start[:, 2] + end[:, 2])
        middle = (start[present] + end[present]) / 2
        samples.append(profile_sums(middle, (start - end)[present, 2], duration, heights, edges))
    return fit_spreading(tracks.step_times, np.array(samples), tracks.span, heights, edges, tracks.container,
                         radius, buffer, method)


def moment(velocity, centres):
    """Second moment in x about the mean, (...), of profiles (..., X)."""
    total = velocity.sum(axis=-1)
    return (velocity * centres**2).sum(axis=-1) / total - ((velocity * centres).sum(axis=-1) / total)**2


def variance_methods(edges, container, radius, buffer):
    """name -> function from profiles (..., X) to variances (...); not a number outside VARIANCES."""
    centres = (edges[1:] + edges[:-1]) / 2
    gaussians = np.exp(-centres**2 / (2 * VARIANCES[:, None]))
    walled = walled_profiles(edges, VARIANCES, container.half_width, buffer, radius)
    moments = moment(walled, centres)
    return {
        "gaussian": lambda profiles: fit_family(profiles, gaussians, VARIANCES)[0],
        "moment": lambda profiles: moment(profiles, centres),
        "walled_gaussian": lambda profiles: fit_family(profiles, walled, VARIANCES)[0],
        "walled_moment": lambda profiles: np.interp(moment(profiles, centres), moments, VARIANCES, np.nan, np.nan),
    }


def fit_spreading(times, samples, span, heights, edges, container, radius, buffer, method):
    """Spreading from ``profile_sums`` of each step, (T, 2 H X); raises CalibrationError where nothing spreads.

    radius : R_s, d; it shifts all walled variances alike
    """
    centres = (edges[1:] + edges[:-1]) / 2

    def profile(sums):
        both = sums.reshape(*sums.shape[:-1], 2, len(heights), len(centres))
        with np.errstate(invalid="ignore", divide="ignore"):
            return both[..., 1, :, :] / both[..., 0, :, :]

    profiles = estimate(times, samples, span, profile)
    if not np.isfinite(profiles.value).all():
        raise CalibrationError(f"no grains somewhere in |x| < {edges[-1]:g} d, {heights[0] - SLICE / 2:g} d < z < "
                               f"{heights[-1] + SLICE / 2:g} d: b_s needs v_z profiles from wall to wall")
    variances = {name: combine(function, profiles)
                 for name, function in variance_methods(edges, container, radius, buffer).items()}
    lines = {name: combine(lambda values: np.stack(fit_line(heights, values), axis=-1), variance)
             for name, variance in variances.items()}
    slope = lines[method][0]
    if not slope.is_determined():
        raise CalibrationError(f"the v_z profile does not widen with height (its variance grows by {slope.value:.2f} +- "
                               f"{slope.error:.2f} d): no b_s")
    curves = walled_profiles(edges, variances[method].value, container.half_width, buffer, radius)
    amplitude = (profiles.value * curves).sum(axis=1) / (curves**2).sum(axis=1)
    return Spreading(heights, centres, profiles, amplitude[:, None] * curves, variances, lines, method,
                     combine(lambda value: value / 2, slope))
