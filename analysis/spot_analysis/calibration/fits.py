# SPDX-License-Identifier: GPL-2.0-or-later
"""Least-squares fits of curves with a free amplitude and one parameter on an even table."""

import numpy as np

from ..statistics import fits


def fit_family(values, curves, parameters):
    """The member of a family of curves that fits best, amplitude free.

    values : (..., k)
    curves : (p, k), the family at p values of its parameter
    parameters : (p,) equally spaced
    Returns parameter and amplitude, each (...); not a number where the best lies at the end of the table.
    """
    amplitude, place = fits.fit_family(np.asarray(values), curves)
    return parameters[0] + place * (parameters[1] - parameters[0]), amplitude
