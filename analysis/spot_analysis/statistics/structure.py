# SPDX-License-Identifier: GPL-2.0-or-later
"""Structure of one packing: packing fraction, contacts and badness; lengths in d."""

import math

import numpy as np


def packing_fraction(grains, region, container):
    """Volume of ``grains`` spheres over the region's volume from wall to wall."""
    return grains * math.pi / 6 / (region.area() * 2 * container.half_depth)


def contacts_per_grain(pairs):
    """Mean number of grains, walls not counted, that overlap a grain of the region."""
    return pairs.ends[pairs.distance < 1].sum() / pairs.grains


def badness(pairs):
    """B = (1/p) sum_i sum_j (delta_ij/d)^2 over the p grains i of the region, all j (2010).

    A pair inside the region is thus counted from both ends.
    """
    overlap = np.maximum(1 - pairs.distance, 0)
    return (pairs.ends * overlap**2).sum() / pairs.grains
