# SPDX-License-Identifier: GPL-2.0-or-later
"""b_s from the width of the v_z profile, which grows with height as spots spread."""

from dataclasses import dataclass

import numpy as np

from ..statistics import profile_width
from ..statistics.fits import fit_line
from .estimate import CalibrationError, Estimate, combine
from .view import estimate_pairs

VARIANCES = np.arange(5.0, 600.0, 1.0)  # d^2
FINE = 10  # points a bin for the walled form
WIDENING = 0.05  # share by which a flow may get wider from one half of the interval to the other and still count as steady
IMAGES = 3  # reflections on each side; with 24 d to the wall they hold up to a variance of 2000 d^2


@dataclass(frozen=True)
class Spreading:
    """Profiles at the H heights of profile_width.LINE in X bins, and the variances that follow.

    heights : (H,) d; centres : (X,) d
    profiles : Estimate (H, X), downward velocity, d/tau
    fitted : (H, X), the walled form
    variance : Estimate (H,), d^2, of the spots between walls whose profile has the same second moment. Walls turn a
        Gaussian's tails back, so its own moment is too small; and DEM's profile is flatter on top than a Gaussian, which fits
        feel more than moments do.
    line : Estimate (2,), slope and intercept of variance against height
    diffusion : Estimate, b_s = slope / 2, d
    """

    heights: np.ndarray
    centres: np.ndarray
    profiles: Estimate
    fitted: np.ndarray
    variance: Estimate
    line: Estimate
    diffusion: Estimate


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


def measure_widening(view):
    """Growth of the v_z profiles' second moments, averaged over the heights of profile_width.LINE, from the first half of the
    view's interval to the second, over their mean; an Estimate. DEM's flow gets wider long after its outflow is steady, and b_s
    with it."""
    run = view.run
    columns = profile_width.counts_and_sums(run, profile_width.in_line(run.profile_heights))
    late = (run.profile_start + run.profile_end) / 2 > np.mean(view.interval.span)
    halves = np.stack([columns * ~late[:, None, None, None], columns * late[:, None, None, None]], axis=1)

    def growth(sums):
        both = sums.reshape(*sums.shape[:-1], *halves.shape[1:])
        first, second = np.moveaxis(profile_width.moment_variance(both[..., 0, :, :], both[..., 1, :, :],
                                                                  run.profile_edges).mean(axis=-1), -1, 0)
        return 2 * (second - first) / (second + first)

    return estimate_pairs(view, run.profile_start, run.profile_end, halves.reshape(len(halves), -1), growth)


def warn_of_widening(view, warn):
    """Calls warn(text) where the flow does not keep its width."""
    growth = measure_widening(view)
    if abs(growth.value) > max(WIDENING, 2 * growth.error):
        start, end = view.interval.span
        warn(f"the flow does not keep its width: variances of its v_z profile change by {100 * growth.value:+.0f} +- "
             f"{100 * growth.error:.0f} % between the halves of {start:g} to {end:g} tau, and b_s, w with them; "
             "a later interval (--from) is better")


def measure_spreading(view, radius, buffer):
    """Spreading of the view; raises CalibrationError where nothing spreads.

    radius : R_s, d; it shifts all variances alike; buffer : distance of spot centres from the walls, d
    """
    run = view.run
    used = profile_width.in_line(run.profile_heights)
    columns = profile_width.counts_and_sums(run, used)
    return fit_spreading(
        lambda statistic: estimate_pairs(view, run.profile_start, run.profile_end, columns.reshape(len(columns), -1), statistic),
        run.profile_heights[used], run.profile_edges, run.scene.container(), radius, buffer)


def fit_spreading(estimate, heights, edges, container, radius, buffer):
    """Spreading where ``estimate`` makes an Estimate from a statistic of summed counts and sums, (..., 2 H X)."""
    kept = profile_width.kept_bins(edges)

    def velocities(sums):
        both = sums.reshape(*sums.shape[:-1], 2, len(heights), len(edges) - 1)[..., kept]
        with np.errstate(invalid="ignore", divide="ignore"):
            return both[..., 1, :, :] / both[..., 0, :, :]

    x = ((edges[1:] + edges[:-1]) / 2)[kept]
    profiles = estimate(velocities)
    if not np.isfinite(profiles.value).all():
        raise CalibrationError(f"no grains somewhere in |x| < {x[-1] + 0.5:g} d, {heights[0]:g} d < z < {heights[-1]:g} d: "
                               "b_s needs v_z profiles from wall to wall")
    moments = profile_width.moment(x, walled_profiles(edges, VARIANCES, container.half_width, buffer, radius)[:, kept])
    variance = combine(lambda values: np.interp(profile_width.moment(x, values), moments, VARIANCES, np.nan, np.nan), profiles)
    line = combine(lambda values: np.stack(fit_line(heights, values), axis=-1), variance)
    slope = line[0]
    if not slope.is_determined():
        raise CalibrationError(f"the v_z profile does not widen with height (its variance grows by {slope.value:.2f} +- "
                               f"{slope.error:.2f} d): no b_s")
    curves = walled_profiles(edges, variance.value, container.half_width, buffer, radius)[:, kept]
    amplitude = (profiles.value * curves).sum(axis=1) / (curves**2).sum(axis=1)
    return Spreading(heights, x, profiles, amplitude[:, None] * curves, variance, line,
                     combine(lambda value: value / 2, slope))
