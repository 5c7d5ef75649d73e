# SPDX-License-Identifier: GPL-2.0-or-later
"""Least squares for many curves at once: one shape parameter and a free amplitude, and straight lines."""

import numpy as np


def fit_family(values, curves, parameters):
    """The member of a family of curves that fits best, amplitude free.

    values : (..., k)
    curves : (p, k), the family at p values of its parameter
    parameters : (p,) equally spaced
    Returns parameter and amplitude, each (...); not a number where the best lies at the end of the table.

    For a fixed curve f the best amplitude is (y.f)/(f.f) and takes (y.f)^2/(f.f) off the squared residual. Its
    maximum over the table is refined by a parabola.
    """
    squares = (curves**2).sum(axis=1)
    overlap = np.asarray(values) @ curves.T
    gain = np.where(overlap > 0, overlap, 0)**2 / squares
    best = np.argmax(gain, axis=-1)
    inside = (best > 0) & (best < len(parameters) - 1)
    middle = best.clip(1, len(parameters) - 2)
    left, centre, right = (np.take_along_axis(gain, (middle + offset)[..., None], axis=-1)[..., 0]
                           for offset in (-1, 0, 1))
    curvature = left - 2 * centre + right
    with np.errstate(invalid="ignore", divide="ignore"):
        shift = np.where(inside & (curvature < 0), (left - right) / (2 * curvature), np.nan)
    amplitude = np.take_along_axis(overlap, middle[..., None], axis=-1)[..., 0] / squares[middle]
    return parameters[middle] + shift * (parameters[1] - parameters[0]), np.where(inside, amplitude, np.nan)


def fit_line(x, y, weights=None):
    """Slope and intercept, each (...), of straight lines through y (..., k) at x (k,)."""
    x = np.asarray(x, dtype=float)
    weights = np.ones(len(x)) if weights is None else weights
    share = weights / weights.sum()
    mean = (share * x).sum()
    lever = share * (x - mean)
    slope = (np.asarray(y) * lever).sum(axis=-1) / (lever * x).sum()
    return slope, (np.asarray(y) * share).sum(axis=-1) - slope * mean
