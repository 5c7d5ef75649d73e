# SPDX-License-Identifier: GPL-2.0-or-later
"""Packing fraction of a round hopper: volume of grains, cut off where a layer ends, over that of the room inside its
walls.

Lengths are in d. Layers that the free surface comes down into are left out: what is above it would count as loose.
"""

import numpy as np

from .sphere_parts import room, volume_inside

HALF_LAYER = 2.0  # d, of the layers from wall to wall
CORE = 8.0  # d, radius of the core of the cylinder
CORE_LAYER = 6.0  # d, from the lower end of the cylinder upwards
COLUMN = 1.5  # d, width of the columns that must have grains above a layer: a narrower crater is none


def core_radius(scene):
    """d; that of the cylinder where it is narrower."""
    return min(CORE, scene.cylinder_radius / scene.diameter)


def fractions_of_layers(snapshot, scene, heights):
    """Packing fraction around each height from wall to wall, then of the core above the cone; not a number above the
    surface.

    snapshot : of ``passages``; scene : AxialScene
    """
    shoulder = scene.cone_height / scene.diameter
    layers = [(height - HALF_LAYER, height + HALF_LAYER, scene.radius_at) for height in heights]
    layers.append((shoulder, shoulder + CORE_LAYER, lambda z: np.full_like(z, core_radius(scene), dtype=float)))
    return [_fraction(snapshot.positions, *layer, kinks=(shoulder,)) for layer in layers]


def _fraction(positions, low, high, radius_at, kinks):
    if not _is_covered(positions, high, float(radius_at(np.float64(high)))):
        return float("nan")
    near = positions[(positions[:, 2] > low - 0.5) & (positions[:, 2] < high + 0.5)]
    return volume_inside(near, low, high, radius_at).sum() / room(low, high, radius_at, kinks)


def _is_covered(positions, height, radius):
    """Whether all columns inside a radius have grains above a height."""
    above = positions[(positions[:, 2] > height) & (np.hypot(positions[:, 0], positions[:, 1]) < radius)]
    cells = int(np.ceil(2 * radius / COLUMN))
    edges = np.linspace(-radius, radius, cells + 1)
    there = np.histogram2d(above[:, 0], above[:, 1], (edges, edges))[0] > 0
    middles = (edges[1:] + edges[:-1]) / 2
    inside = np.hypot(*np.meshgrid(middles, middles)) < radius - COLUMN / 2
    return bool(len(above) and there[inside].all())
