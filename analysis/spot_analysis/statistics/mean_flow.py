# SPDX-License-Identifier: GPL-2.0-or-later
"""Sideways motion of grains about the mean flow, from which C(r) and b_p are taken; lengths in d.

Between snapshots LAG_TAU apart a grain moves by dx and drops by h. The mean flow would take it h g(x, z) aside, with the
inclination g = sum_k c_k f_k(x, z) of the streamlines; c_k are fitted by least squares to all steps of an interval. Since
h is the grain's own drop, neither pulses of the flow nor its profile across the thickness come in.

What is stored are sums of products of w = (dx, h f_1, ..., h f_m) of two grains, or of one grain at two times. From them
the fluctuations follow for any choice of times, about its own mean flow: that of a grain is q.w with q = (1, -c).

The layer of grains at the walls y = +-half_depth is left out: in DEM it rolls along them, with four times the variance, and
each of its grains by itself, which no spot describes. From wall to wall DEM's b_p is 1.6 times as large.
"""

import numpy as np

from .flow import common_grains
from .region import Region

HALF_WIDTH = 8.0  # d; 2006 takes correlations from a core 16 d wide
WALL_LAYER = 1.5  # d
MARGIN = 8.0  # d to the sides and below; grains that leave the core are followed so far
COVER = 4.0  # d of packing above a region, which keep its grains from the free surface
X_POWERS = (0, 1, 3)
Z_POWERS = (0, 1, 2)
SIZE = 1 + len(X_POWERS) * len(Z_POWERS)
UPPER = np.triu_indices(SIZE)


def core(container, bottom, top):
    """The Region in which fluctuations are measured, far from the walls."""
    return Region(min(HALF_WIDTH, 0.6 * container.half_width), bottom, top, container.depth_off_walls(WALL_LAYER))


def inclination_terms(x, z):
    """f_k at (n,) places; (n, SIZE - 1): x^p / z^q, q = 1, 2, 3.

    A free walk of spots inclines streamlines by x / (2 z) (2006). The powers of 1/z are combined so that each term is about 1
    between z = 25 d and 66 d. With more of them, or of x, DEM's b_p falls by another 3 % (40-92 tau), with polynomials of
    the second degree in z instead it rises by 14 %.
    """
    u, v = x / HALF_WIDTH, (30 / z - 0.83) / 0.37
    return np.stack([30 / z * u**p * v**q for p in X_POWERS for q in Z_POWERS], axis=1)


class Step:
    """All grains in and near a region over one step: ids (n,), middle (n, 3), w (n, SIZE), inside (n,) bool.

    start, end : times, tau; fallen : sum of the drops of the grains inside
    """

    def __init__(self, start, end, region):
        first, second = common_grains(start.ids, end.ids)
        moved = end.positions[second] - start.positions[first]
        middle = start.positions[first] + moved / 2
        near = ((middle[:, 2] > region.bottom - MARGIN) & (middle[:, 2] < region.top)
                & (np.abs(middle[:, 0]) < region.half_width + MARGIN))
        self.start, self.end = start.time, end.time
        self.ids, self.middle, moved = start.ids[first][near], middle[near], moved[near]
        self.inside = region.contains(self.middle)
        terms = inclination_terms(self.middle[:, 0], self.middle[:, 2])
        self.w = np.column_stack([moved[:, 0], -moved[:, 2:] * terms])
        self.fallen = float(-moved[self.inside, 2].sum())


def triangles(matrices):
    """The upper triangles (..., u) of the symmetric parts of matrices (..., SIZE, SIZE)."""
    symmetric = (matrices + np.swapaxes(matrices, -1, -2)) / 2
    return symmetric[..., UPPER[0], UPPER[1]]


def _matrices(flat):
    matrices = np.zeros((*flat.shape[:-1], SIZE, SIZE))
    matrices[..., UPPER[0], UPPER[1]] = flat
    matrices[..., UPPER[1], UPPER[0]] = flat
    return matrices


def about_mean_flow(own, products):
    """Sums of products of fluctuations, (..., k), about the mean flow that fits best.

    own : (..., u), ``triangles`` of the sum of w w^T over the grains that the mean flow is fitted to
    products : (..., k, u), those of k other sums
    """
    matrix = _matrices(own)
    # the pseudo-inverse, since terms may be equal where grains stand on a lattice
    c = np.einsum("...ij,...j->...i", np.linalg.pinv(matrix[..., 1:, 1:], hermitian=True), matrix[..., 1:, 0])
    q = np.concatenate([np.ones((*c.shape[:-1], 1)), -c], axis=-1)
    return np.einsum("...i,...kij,...j->...k", q, _matrices(products), q)
