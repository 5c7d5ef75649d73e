# SPDX-License-Identifier: GPL-2.0-or-later
"""Which local quantity b_eff follows, and which law the sideways flux; on the places of ``flow_places``."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import curve_fit
from scipy.stats import spearmanr

BINS = 10
FLOWING = {"strain": 0.1, "u": 0.03}  # from where on the packing counts as flowing; d/tau
HIGHEST = 68  # d
WALL = 8  # d at the side walls, where friction and not the law shapes the profile
RELATIVE_ERROR, ERROR = 0.06, 0.006  # of v_x / u
DILATION_FLOOR = 0.01  # under the logarithm of the dilation
LAWS = {"Fick, b one number": ("fick",), "b by height": ("fick", "height"), "b by dilation": ("fick", "dilation"),
        "b by share of the axis": ("fick", "share_of_axis"),
        "towards dilation": ("fick", "target")}


@dataclass(frozen=True)
class Collapse:
    """How well one quantity tells log b_eff.

    rank : Spearman's correlation; scatter : standard deviation about the mean curve in BINS bins of equal number
    bias : (k,) mean residual of each interval
    other_bias, other_scatter : of another run about the same curve; None without one
    """

    rank: float
    scatter: float
    bias: np.ndarray
    other_bias: float = None
    other_scatter: float = None


def collapse(rows, name, other=None):
    """Collapse of log b_eff on the column ``name``; raises ValueError with fewer than two places a bin."""
    q, y = rows[name], np.log(rows["b"])
    if len(q) < 2 * BINS:
        raise ValueError(f"{len(q)} places are too few for {BINS} bins")
    order = np.array_split(np.argsort(q, kind="stable"), BINS)
    x, curve = (np.array([values[part].mean() for part in order]) for values in (q, y))
    residual = y - np.interp(q, x, curve)
    found = Collapse(float(spearmanr(q, y)[0]), float(residual.std()), by_interval(rows, residual))
    if not other:
        return found
    apart = np.log(other["b"]) - np.interp(other[name], x, curve)
    return Collapse(found.rank, found.scatter, found.bias, float(apart.mean()), float(apart.std()))


def rank_across(rows):
    """Spearman's correlation of b_eff on one side of the axis with |u_x| / u on the other, which no common noise of u_x makes."""
    return float(spearmanr(np.concatenate([rows["b_left"], rows["b_right"]]), np.concatenate([rows["s_right"], rows["s_left"]]))[0])


def by_interval(rows, values):
    """(k,) means of values (p,) over the places of each interval, up to the last that has some; not a number where none has."""
    number = np.arange(rows["interval"].max(initial=-1) + 1)
    return np.array([values[rows["interval"] == k].mean() if (rows["interval"] == k).any() else np.nan for k in number])


def flowing(rows, half_width):
    """(p,) bool: where the packing flows, far from the walls, and beside the axis, on which v_x and du/dx vanish."""
    return ((rows["x"] > 2) & (rows["x"] <= half_width - WALL) & (rows["height"] <= HIGHEST) & (rows["height"] >= 8)
            & (rows["strain"] > FLOWING["strain"]) & (rows["u"] > FLOWING["u"]))


def inclination_terms(rows, names):
    """(p, k) terms of v_x / u: "fick" is u_x / u, "target" -(ln c)_x, any other the first times that quantity.

    Steps that prefer to lead to a larger c give v_x = b (u_x - kappa u (ln c)_x), kappa > 0; an Ito law with b ~ c^m has kappa = -m,
    Fick's law 0.
    """
    fick = rows["u_x"] / rows["u"]
    target = -rows["dilation_gradient"] / np.maximum(rows["dilation"], DILATION_FLOOR)
    of = {"fick": np.ones_like(fick), "height": np.log(rows["height"] / 30)}
    return np.stack([target if name == "target" else fick * of.get(name, rows.get(name)) for name in names], axis=1)


@dataclass(frozen=True)
class Misfit:
    """rms : relative rms residual of v_x / u; bias : (k,) mean of residual over v_x / u in each interval"""

    rms: float
    bias: np.ndarray


def error_of(inclination):
    """Of v_x / u, about what the two sides of the axis differ by."""
    return RELATIVE_ERROR * np.abs(inclination) + ERROR


def misfit(rows, law):
    """Misfit of a law (p,) for v_x / u."""
    y = rows["v_x"] / rows["u"]
    return Misfit(float(np.sqrt(np.mean(((y - law) / error_of(y))**2)) * RELATIVE_ERROR), by_interval(rows, 1 - law / y))


def fit_inclination(rows, names):
    """Coefficients (k,) of ``inclination_terms`` by weighted least squares."""
    y, terms = rows["v_x"] / rows["u"], inclination_terms(rows, names)
    error = error_of(y)
    return np.linalg.lstsq(terms / error[:, None], y / error, rcond=None)[0]


def saturating(rows, b_0, s_1, kappa=0.0):
    """v_x / u = (b u_x + kappa u b_x) / u with b = b_0 / (1 + s / s_1), (p,): kappa is 0 by Fick, 1 by Ito, where steps are as long as
    where they start asks for, and -1 where the place they lead to decides."""
    b = b_0 / (1 + rows["shear_per_fall"] / s_1)
    return b * (rows["u_x"] / rows["u"] - kappa * rows["shear_gradient"] / (s_1 + rows["shear_per_fall"]))


def fit_saturating(rows, start=(2.0, 0.4)):
    """b_0, s_1, and kappa too if ``start`` has three, and their standard errors, as if places were independent."""
    y = rows["v_x"] / rows["u"]
    found, covariance = curve_fit(lambda _, *p: saturating(rows, *p), y, y, start, sigma=error_of(y))
    return found, np.sqrt(np.diag(covariance))
