# SPDX-License-Identifier: GPL-2.0-or-later
"""Width of the flow against height: Gaussian fits of the v_z profiles and the straight line of their variances (2006).

A spot that walks freely spreads as Var(x) = 2 b_s z, so half the slope of the line is the diffusion length b_s.
"""

import numpy as np

from .fits import fit_gaussian, fit_line

HEIGHTS = (10, 20, 30, 40, 50, 60)  # d, reported
MOMENTS = (10, 30, 50)  # d; second moments, which the shape of the tails enters
LINE = (10, 40)  # d; heights that the line is fitted through
WALL = 1.0  # d left out at each wall
MEANING = {
    "profile_variance_slope": "of the second moment over z, 10-40 d",
    "variance_slope": "of gaussian_variance over z, 10-40 d; 2 b_s",
    "variance_intercept": "of the same line",
    "profile_variance_*": "second moment of the profile of v_z across x",
    "gaussian_variance_*": "of the Gaussian that fits this profile",
}
NEEDS = {"*": ("height", "pairs")}


def kept_bins(edges):
    """(X,) bool: bins that are not within WALL of a wall."""
    return np.abs(edges[1:] + edges[:-1]) / 2 < edges[-1] - WALL


def in_line(heights):
    """(h,) bool: heights that the line is fitted through."""
    return (heights >= LINE[0]) & (heights <= LINE[1])


def _velocities(counts, sums, edges):
    """Places (X,) and mean downward velocities (..., X) of the bins that are kept, not a number where they are empty.

    counts, sums : (..., X) of ``flow.velocity_profile``, added over time
    """
    kept = kept_bins(edges)
    with np.errstate(invalid="ignore", divide="ignore"):
        return ((edges[1:] + edges[:-1]) / 2)[kept], sums[..., kept] / counts[..., kept]


def moment(x, velocity):
    """Second moment in x (X,) about the mean of profiles (..., X); bins of width b add b^2/12, which is left in."""
    with np.errstate(invalid="ignore", divide="ignore"):
        total = velocity.sum(axis=-1)
        return (velocity * x**2).sum(axis=-1) / total - ((velocity * x).sum(axis=-1) / total)**2


def moment_variance(counts, sums, edges):
    """``moment`` of the profile of mean downward velocity, (...) d^2."""
    return moment(*_velocities(counts, sums, edges))


def gaussian_variance(counts, sums, edges):
    """Variance of the Gaussian, centred on the axis, that fits this profile, (...) d^2; all bins weigh the same."""
    return fit_gaussian(*_velocities(counts, sums, edges))[1]**2


def line(heights, variances):
    """slope, intercept through the variances (..., h) at heights within LINE."""
    used = in_line(heights)
    return fit_line(heights[used], variances[..., used])


def mean_variances(view):
    """Heights (h,) of the stored profiles and their variances over the interval (h,)."""
    run = view.run
    rows = view.pair_rows(run.profile_start, run.profile_end)
    return run.profile_heights, gaussian_variance(run.profile_counts[rows].sum(axis=0),
                                                  run.profile_sums[rows].sum(axis=0), run.profile_edges)


def quantities(view):
    run = view.run
    heights = run.profile_heights
    used = np.flatnonzero(in_line(heights))

    def at(z, width):
        return _estimate(view, "d^2", [np.searchsorted(heights, z)], width, lambda variances: variances[..., 0])

    def line_of(unit, width, part):
        return _estimate(view, unit, used, width, lambda variances: fit_line(heights[used], variances)[part])

    return {**{f"profile_variance_{z}d": at(z, moment_variance) for z in MOMENTS},
            "profile_variance_slope": line_of("d", moment_variance, 0),
            **{f"gaussian_variance_{z}d": at(z, gaussian_variance) for z in HEIGHTS},
            "variance_slope": line_of("d", gaussian_variance, 0), "variance_intercept": line_of("d^2", gaussian_variance, 1)}


def counts_and_sums(run, chosen):
    """(P, 2, h, X): counts and sums of the profiles at the heights ``chosen``, of each pair of snapshots."""
    return np.stack([run.profile_counts[:, chosen], run.profile_sums[:, chosen]], axis=1)


def _estimate(view, unit, indices, width, statistic):
    """Value of ``statistic``, which maps the variances (..., h) of profiles number ``indices`` to (...); ``width`` maps
    counts and sums (..., h, X) and edges to variances."""
    run = view.run

    def of_sums(sums):
        return statistic(width(*np.split(sums.reshape(*sums.shape[:-1], 2 * len(indices), -1), 2, axis=-2), run.profile_edges))

    columns = counts_and_sums(run, indices)
    columns = columns.reshape(len(columns), 2 * len(indices) * (len(run.profile_edges) - 1))
    return view.estimate_pairs(unit, run.profile_start, run.profile_end, columns, of_sums)


def mean_profile(view, index):
    """Mean downward velocity across x in profile number ``index``, (X,) d/tau; not a number without data."""
    run = view.run
    rows = view.pair_rows(run.profile_start, run.profile_end)
    with np.errstate(invalid="ignore", divide="ignore"):
        return run.profile_sums[rows, index].sum(axis=0) / run.profile_counts[rows, index].sum(axis=0)


def fitted_gaussian(view, index, x):
    """The Gaussian that fits this profile, at x (k,)."""
    edges = view.run.profile_edges
    kept = kept_bins(edges)
    amplitude, width = fit_gaussian(((edges[1:] + edges[:-1]) / 2)[kept], mean_profile(view, index)[kept])
    return amplitude * np.exp(-x**2 / (2 * width**2))
