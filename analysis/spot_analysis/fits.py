# SPDX-License-Identifier: GPL-2.0-or-later
"""Least-squares fits of an amplitude and one length, for many curves at once, as the bootstrap needs."""

import numpy as np


def fit_family(curves, family, lengths):
    """Fit amplitude * family(length) to each curve.

    curves : (..., n) samples
    family : (g, n) the form of amplitude 1 at the same points, for each of ``lengths``
    lengths : (g,) ascending, evenly spaced in the logarithm

    For a given length the best amplitude is a projection, so only the length is searched: over the grid, then at the
    top of the parabola through the best three. Returns amplitude (...) and length (...); not a number where a curve has
    a gap or the best length is an end of the grid, which means that the form does not fit.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        overlap = curves @ family.T
        norm = (family**2).sum(axis=1)
        explained = overlap * np.abs(overlap) / norm
        best = np.argmax(np.where(np.isfinite(explained), explained, -np.inf), axis=-1)
        inner = (best > 0) & (best < len(lengths) - 1) & np.isfinite(curves).all(axis=-1)
        middle = np.clip(best, 1, len(lengths) - 2)
        left, top, right = _three(explained, middle)
        shift = (left - right) / (2 * (left - 2 * top + right))
        length = lengths[middle] * (lengths[1] / lengths[0])**shift
        left, top, right = _three(overlap / norm, middle)
        amplitude = top + shift * (right - left) / 2 + shift**2 * (left - 2 * top + right) / 2
    return np.where(inner, amplitude, np.nan), np.where(inner, length, np.nan)


def _three(values, middle):
    """The values (..., g) before, at and after index ``middle`` (...)."""
    return (np.take_along_axis(values, (middle + k)[..., None], -1)[..., 0] for k in (-1, 0, 1))


def fit_exponential(x, curves):
    """amplitude, length of amplitude exp(-x / length); x (n,), curves (..., n)."""
    lengths = np.geomspace(0.1, 50, 600)
    return fit_family(curves, np.exp(-x / lengths[:, None]), lengths)


def fit_gaussian(x, curves):
    """amplitude, width of amplitude exp(-x^2 / (2 width^2)); x (n,), curves (..., n)."""
    widths = np.geomspace(0.5, 60, 600)
    return fit_family(curves, np.exp(-x**2 / (2 * widths[:, None]**2)), widths)


def fit_line(x, curves):
    """slope, intercept of a straight line; x (n,), curves (..., n)."""
    centred = x - x.mean()
    slope = curves @ centred / (centred**2).sum()
    return slope, curves.mean(axis=-1) - slope * x.mean()
