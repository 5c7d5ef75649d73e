# SPDX-License-Identifier: GPL-2.0-or-later
"""Packing fraction in flow against the shear per distance fallen, cell by cell; lengths in d."""

import numpy as np
from scipy.optimize import curve_fit

CELL = 4  # d
LOWEST = 4  # d
SLOWEST = 0.05  # of u on the axis at the same height
BULK = 8  # d; cells below are left out of fits
FORMS = {"line": (lambda s, phi, a: phi - a * s, (0.58, 0.05)),
         "saturating": (lambda s, phi, a, s_0: phi - a * s / (1 + s / s_0), (0.585, 0.5, 0.03))}


def cells(measurement, number):
    """name -> (p,) over the cells of interval ``number`` that flow and touch no side wall.

    x, z : middle; fraction; noise : half the difference of the fraction between the two sides
    s : |du/dx| / u; s_full : the same of the whole rate of strain, sqrt((u_x - v_xz)^2 + 2 v_xx^2 + 2 u_z^2) / u; 1/d
    share_of_axis : u over that on the axis; dilation, strain, fallen : as in FlowFields
    """
    both, left, right = (measurement.fields(number, side) for side in (0, -1, 1))
    full = np.sqrt((both.u_x - both.v_xz)**2 + 2 * both.v_xx**2 + 2 * both.u_z**2)
    rows = []
    for z in range(LOWEST, both.top - CELL + 1, CELL):
        axis = both.u[:CELL, z:z + CELL].mean()
        for x in range(0, len(both.u) - CELL - 1, CELL):
            at = slice(x, x + CELL), slice(z, z + CELL)
            u = both.u[at].mean()
            if u > SLOWEST * axis > 0:
                rows.append({"x": x + CELL / 2, "z": z + CELL / 2, "fraction": both.fraction[at].mean(),
                             "noise": (left.fraction[at].mean() - right.fraction[at].mean()) / 2, "s": np.abs(both.u_x[at]).mean() / u,
                             "s_full": full[at].mean() / u, "share_of_axis": u / axis,
                             **{name: getattr(both, name)[at].mean() for name in ("dilation", "strain", "fallen")}})
    return {name: np.array([row[name] for row in rows]) for name in rows[0]} if rows else {}


def fit(s, fraction, form):
    """Parameters of FORMS[form] and the residuals (p,) of fraction (p,) at s (p,)."""
    function, start = FORMS[form]
    found = curve_fit(function, s, fraction, start, maxfev=20000)[0]
    return found, fraction - function(s, *found)
