# SPDX-License-Identifier: GPL-2.0-or-later
"""The width of the flow that a law of b makes of DEM's profile low down: du/dz + dJ/dx = -loss upwards, in d and tau.

J = -b (u_x - kappa u (ln c)_x) is the flux that spots carry aside, c the dilation of the material there. It is that of steps of equal
length whose odds go as c^(kappa/2) at either end; the loss is what the material takes up where it dilates.
"""

import numpy as np
from scipy.optimize import least_squares

from .fits import fit_gaussian
from .profile_width import WALL, moment

START = 6  # d, where the march begins
STEP = 0.1  # d; stable for b STEP below half the square of a bin
DILATION_FLOOR = 0.005  # added to c, which is 0 where nothing has flowed
HEIGHTS = (10, 20, 30, 40, 50)  # d


def march(fields, b, kappa=0.0, shear=np.inf, with_loss=True, heights=HEIGHTS):
    """height -> profile (X,) of u, from that of ``fields`` (FlowFields) at z = START; heights beyond fields.top are left out.

    b : d; shear : b falls as b / (1 + s / shear), s = |u_x| / u in 1/d
    """
    u = profile(fields.u, START)
    odds = (np.maximum(fields.dilation, 0) + DILATION_FLOOR)**(kappa / 2)
    found, wanted = {}, {round((z - START) / STEP): z for z in heights if z <= fields.top}
    for number in range(1, max(wanted, default=0) + 1):
        level = int(START + (number - 0.5) * STEP)
        tilt = odds[1:, level] / odds[:-1, level]
        middle = (u[1:] + u[:-1]) / 2
        here = b / (1 + np.abs(np.diff(u)) / np.maximum(middle, 1e-12) / shear)
        aside = here * (u[:-1] * tilt - u[1:] / tilt)
        taken = fields.loss[:, level] if with_loss else 0
        u = np.maximum(u - STEP * (np.diff(aside, prepend=0, append=0) + taken), 0)
        if number in wanted:
            found[wanted[number]] = u
    return found


def profile(u, height):
    """(X,) of a field (X, Z) at a height in whole d, 2 d thick."""
    return u[:, height - 1:height + 1].mean(axis=1)


def widths(u):
    """Second moment and variance of the Gaussian that fits a profile (X,) of one side of the axis, d^2."""
    x, whole = np.arange(-len(u), len(u)) + 0.5, np.concatenate([u[::-1], u])
    kept = np.abs(x) < len(u) - WALL
    return np.array([moment(x[kept], whole[kept]), fit_gaussian(x[kept], whole[kept])[1]**2])


def errors(fields, **law):
    """Logarithm of the widths (h, 2) that ``march`` makes over those of ``fields``; not a number where no Gaussian fits."""
    return np.array([np.log(widths(u) / widths(profile(fields.u, z))) for z, u in march(fields, **law).items()])


def fit(runs, start, **fixed):
    """The law of least squared ``errors`` over several FlowFields: name -> value, and their rms; where no Gaussian fits the error is 1.

    start : name -> value to begin with, of the parameters of ``march`` that are fitted
    """
    names = list(start)

    def residuals(values):
        return np.concatenate([np.nan_to_num(errors(fields, **dict(zip(names, values)), **fixed), nan=1).ravel() for fields in runs])

    found = least_squares(residuals, list(start.values()), diff_step=0.01)
    return dict(zip(names, map(float, found.x))), float(np.sqrt(np.mean(found.fun**2)))
