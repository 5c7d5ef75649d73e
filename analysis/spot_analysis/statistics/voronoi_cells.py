# SPDX-License-Identifier: GPL-2.0-or-later
"""Volumes of the Voronoi cells of the grains between the walls; lengths in d.

Walls are planes halfway between the grains near them and their mirror images. Cell volumes come from the tetrahedra of
the Delaunay triangulation: cut along the planes through its centre, a tetrahedron falls into pieces, two for each of its
edges and each face that holds the edge, which belong half to one end's cell and half to the other's.
"""

import itertools

import numpy as np
from scipy.spatial import Delaunay

MIRRORED = 2.0  # d from a wall; a cell of a dense packing reaches less far
OPEN = 2.0  # d^3; cells above it are those of the free surface


def cell_volumes(points):
    """Volume of each point's Voronoi cell (n,), d^3; meaningless where the cell is open (at the convex hull)."""
    tetrahedra = Delaunay(points).simplices
    corners = points[tetrahedra]
    centre, proper = _circumcentres(corners)
    volumes = np.zeros(len(points))
    for i, j in itertools.combinations(range(4), 2):
        p = corners[:, i]
        edge = corners[:, j] - p
        middle = p + edge / 2
        length = np.sqrt(_dot(edge, edge))
        along = edge / length[:, None]
        k, l = (m for m in range(4) if m not in (i, j))
        pieces = 0
        for third, apex in ((k, l), (l, k)):
            # of the face i j third: direction in the face away from the edge, and normal towards the apex
            inward = _unit(_without(corners[:, third] - p, along))
            normal = _unit(_without(_without(corners[:, apex] - p, along), inward))
            to_centre = centre - middle
            pieces = pieces + _dot(to_centre, inward) * _dot(to_centre, normal)
        half = np.where(proper, length / 12 * pieces, 0)
        volumes += np.bincount(tetrahedra[:, i], half, len(points)) + np.bincount(tetrahedra[:, j], half, len(points))
    return volumes


def _circumcentres(corners):
    """Centres (t, 3), and which tetrahedra are not flat.

    A grain, its neighbour and their mirror images lie on one circle, so flat tetrahedra do occur. They hold no volume.
    """
    edges = corners[:, 1:] - corners[:, :1]
    a, b, c = edges[:, 0], edges[:, 1], edges[:, 2]
    bc, ca, ab = np.cross(b, c), np.cross(c, a), np.cross(a, b)
    determinant = _dot(a, bc)
    proper = np.abs(determinant) > 1e-9
    with np.errstate(invalid="ignore", divide="ignore"):
        offset = (_dot(a, a)[:, None] * bc + _dot(b, b)[:, None] * ca + _dot(c, c)[:, None] * ab) \
            / (2 * np.where(proper, determinant, 1))[:, None]
    return corners[:, 0] + offset, proper


def _dot(one, other):
    return np.einsum("nk,nk->n", one, other)


def _without(vectors, direction):
    """The part perpendicular to ``direction``."""
    return vectors - _dot(vectors, direction)[:, None] * direction


def _unit(vectors):
    length = np.sqrt(_dot(vectors, vectors))
    return vectors / np.where(length > 0, length, 1)[:, None]


def with_mirror_images(points, container, reach=MIRRORED):
    """The points (n, 3), followed by their images in walls and base closer than ``reach``, images of images too.

    Where the silo repeats, the points have to be in one period, and have images in the next ones.
    """
    walls = [(0, container.half_width), (0, -container.half_width), (2, 0.0)]
    if container.periodic:
        next_ones = [points[side * points[:, 1] > container.half_depth - reach] - [0, side * container.period, 0] for side in (-1, 1)]
        points = np.vstack([points, *next_ones])
    else:
        walls[2:2] = [(1, container.half_depth), (1, -container.half_depth)]
    for axis, wall in walls:
        near = np.abs(points[:, axis] - wall) < reach
        if axis == 2:
            near &= (points[:, 2] > 0) & (np.hypot(points[:, 0], points[:, 1]) > container.orifice_radius)
        images = points[near].copy()
        images[:, axis] = 2 * wall - images[:, axis]
        points = np.vstack([points, images])
    return points


def cells_in_container(positions, container):
    """Volume of the cell of each grain (n,), d^3, cut off by walls and base; infinite at the free surface."""
    return _first_cells(with_mirror_images(container.in_period(positions), container), len(positions))


def cells_in_hopper(positions, hopper):
    """Volume of the cell of each grain (n,), d^3, cut off by cone and cylinder; infinite at free surface and outlet.

    A wall is taken for the plane that touches it next to each grain.
    """
    return _first_cells(np.vstack([positions, hopper.images(positions, MIRRORED)]), len(positions))


def cells_without_walls(positions):
    """Volume of the cell of each grain (n,), d^3; infinite at walls and at the free surface."""
    return _first_cells(positions, len(positions))


def _first_cells(points, count):
    """Volumes of the cells of the first ``count`` points, infinite where they are open."""
    if count < 5:
        return np.full(count, np.inf)
    # a far frame closes all cells, so that those of the hull come out large instead of meaningless
    low, high = points.min(axis=0) - 20, points.max(axis=0) + 20
    frame = np.array(list(itertools.product(*zip(low, (low + high) / 2, high))))
    centre = np.all(frame == (low + high) / 2, axis=1)
    volumes = cell_volumes(np.vstack([points, frame[~centre]]))[:count]
    return np.where((volumes > 0) & (volumes < OPEN), volumes, np.inf)
