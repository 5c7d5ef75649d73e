# SPDX-License-Identifier: GPL-2.0-or-later
"""Of what sizes the free surface is: grains that roll down a slope may part by size."""

import numpy as np

COLUMN = 2.5  # d, width of columns along x, from wall to wall in y
DEPTH = 3.0  # d, below the highest grain of a column


def surface_share(positions, volumes, large):
    """Volume of large grains over that of all within ``DEPTH`` of the highest centre in their column.

    positions : (n, 3), d; volumes : (n,); large : (n,) bool; not a number where there are no grains
    """
    if len(positions) == 0:
        return float("nan")
    _, column = np.unique(np.floor(positions[:, 0] / COLUMN), return_inverse=True)
    highest = np.full(column.max() + 1, -np.inf)
    np.maximum.at(highest, column, positions[:, 2])
    here = positions[:, 2] > highest[column] - DEPTH
    return float(volumes[here & large].sum() / volumes[here].sum())
