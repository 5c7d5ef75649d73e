# SPDX-License-Identifier: GPL-2.0-or-later
"""Least-squares fits of an amplitude and one length, for many curves at once, as the bootstrap needs."""

import numpy as np


def fit_family(curves, family):
    """Fit amplitude * form to each curve, over a table of forms.

    curves : (..., n) samples
    family : (g, n) the form of amplitude 1 at the same points, for g values of its parameter in order

    For a given form the best amplitude is a projection, so only the table is searched, then the top of the parabola
    through the best three taken. Returns amplitude (...) and place in the table (...), between 0 and g - 1 and not whole;
    not a number where a curve has a gap or the best place is an end of the table, which means that the form does not fit.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        overlap = curves @ family.T
        norm = (family**2).sum(axis=1)
        explained = overlap * np.abs(overlap) / norm
        best = np.argmax(np.where(np.isfinite(explained), explained, -np.inf), axis=-1)
        inner = (best > 0) & (best < len(family) - 1) & np.isfinite(curves).all(axis=-1)
        middle = np.clip(best, 1, len(family) - 2)
        left, top, right = _three(explained, middle)
        shift = (left - right) / (2 * (left - 2 * top + right))
        left, top, right = _three(overlap / norm, middle)
        amplitude = top + shift * (right - left) / 2 + shift**2 * (left - 2 * top + right) / 2
    return np.where(inner, amplitude, np.nan), np.where(inner, middle + shift, np.nan)


def _three(values, middle):
    """The values (..., g) before, at and after index ``middle`` (...)."""
    return (np.take_along_axis(values, (middle + k)[..., None], -1)[..., 0] for k in (-1, 0, 1))


def _fit_length(curves, form, lengths):
    """amplitude, length; ``form`` maps lengths (g, 1) to a family (g, n), ``lengths`` (g,) are a geometric series."""
    amplitude, place = fit_family(curves, form(lengths[:, None]))
    return amplitude, lengths[0] * (lengths[1] / lengths[0])**place


def fit_exponential(x, curves):
    """amplitude, length of amplitude exp(-x / length); x (n,), curves (..., n)."""
    return _fit_length(curves, lambda length: np.exp(-x / length), np.geomspace(0.1, 50, 600))


def fit_gaussian(x, curves):
    """amplitude, width of amplitude exp(-x^2 / (2 width^2)); x (n,), curves (..., n)."""
    return _fit_length(curves, lambda width: np.exp(-x**2 / (2 * width**2)), np.geomspace(0.5, 60, 600))


def fit_line(x, curves, weights=None):
    """slope, intercept, each (...), of straight lines through curves (..., n) at x (n,); weights (n,)."""
    x = np.asarray(x, dtype=float)
    weights = np.ones(len(x)) if weights is None else weights
    share = weights / weights.sum()
    mean = (share * x).sum()
    lever = share * (x - mean)
    slope = np.asarray(curves) @ lever / (lever * x).sum()
    return slope, np.asarray(curves) @ share - slope * mean
