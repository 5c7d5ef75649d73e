# SPDX-License-Identifier: GPL-2.0-or-later
"""b_eff = v_x / (du/dx) and what it may depend on, place by place: columns of numbers from the fields of several intervals.

A spot that climbs carries flux aside as b du/dx (2006: rho_z = b rho_xx, where the density rho of spots goes as u = -v_z), and grains
move against it. Lengths in d, times in tau.
"""

import numpy as np

STEP = 4  # d between places along z; they are 2 d wide and high
LOWEST = 6  # d
SLOWEST = 0.03  # of u on the axis at the same height
STILL = 0.004  # d/tau; what is slower is noise
CANDIDATES = ("dilation", "dilation_1d", "dilation_2d", "dilation_3d", "dilation_gradient", "height", "shear_per_fall", "shear",
              "strain", "fallen", "share_of_axis")


def places(measurement, wall=2):
    """name -> (p,) over all places of all intervals at which both sides of the axis have b_eff > 0.

    measurement : ``flow_sums``.Measurement; wall : d at the side walls that are left out

    interval : its number; x, height : of the place; b, noise : b_eff and half the difference of its logarithm between the two sides;
    b_left, b_right, s_left, s_right : b_eff and |u_x| / u of one side alone, whose noises are independent
    u, v_x, u_x; the CANDIDATES: dilation_1d to 3d are that so far outwards and 1 d up, where a step leads; shear_per_fall is
    |u_x| / u, 1/d, and shear_gradient its derivative along x; share_of_axis is u over that on the axis
    """
    rows = [row for number in range(len(measurement.intervals)) if measurement.pairs(number) for row in _places(measurement, number, wall)]
    return {name: np.array([row[name] for row in rows]) for name in rows[0]} if rows else {}


def _places(measurement, number, wall):
    both, left, right = (measurement.fields(number, side) for side in (0, -1, 1))
    width = both.u.shape[0]

    def mean(fields, name, x, z):
        x = min(x, width - 2)
        return getattr(fields, name)[x:x + 2, z - 1:z + 1].mean()

    for z in range(LOWEST, both.top, STEP):
        axis = mean(both, "u", 0, z)
        for x in range(0, width - 1 - wall, 2):
            u, u_x, v_x = (mean(both, name, x, z) for name in ("u", "u_x", "v_x"))
            sides = [mean(side, "v_x", x, z) / (mean(side, "u_x", x, z) or np.nan) for side in (left, right)]
            if u < max(SLOWEST * axis, STILL) or not min(sides) > 0 or not v_x / u_x > 0:
                continue
            s_left, s_right = (abs(mean(side, "u_x", x, z)) / mean(side, "u", x, z) for side in (left, right))
            yield {"b_left": sides[0], "b_right": sides[1], "s_left": s_left, "s_right": s_right, "interval": number,
                   "x": x + 1, "height": z, "u": u, "v_x": v_x, "u_x": u_x, "b": v_x / u_x,
                   "noise": abs(np.log(sides[0] / sides[1])) / 2, "shear": abs(u_x), "shear_per_fall": abs(u_x) / u,
                   "shear_gradient": mean(both, "s_x", x, z),
                   "share_of_axis": u / axis, **{f"dilation_{k}d": mean(both, "dilation", x + k, z + 1) for k in (1, 2, 3)},
                   **{name: mean(both, name, x, z) for name in ("dilation", "dilation_gradient", "strain", "fallen")}}


def chosen(rows, kept):
    """The places of ``rows`` at which ``kept`` (p,) is true."""
    return {name: values[kept] for name, values in rows.items()}
