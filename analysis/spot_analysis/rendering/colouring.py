# SPDX-License-Identifier: GPL-2.0-or-later
"""What grains are coloured by: a number for each, not a number where it is unknown."""

import math

import numpy as np

from ..base.errors import AnalysisError
from ..reading.hopper import Hopper
from ..statistics.voronoi_cells import MIRRORED, cells_in_container, cells_in_hopper, cells_without_walls

EQUAL = 0.01  # relative difference of diameters up to which grains are of one size


class StartingLayer:
    """Number of the layer of ``height`` d in which a grain was in the first snapshot."""

    LABEL = None

    def __init__(self, run, height):
        self._height = height
        self._ids = None

    def see(self, grains):
        if self._ids is None:
            self._ids, self._layers = grains.ids, np.floor(np.maximum(grains.positions[:, 2], 0) / self._height)

    def values(self, grains, chosen):
        return _of_earlier(self._ids, self._layers, grains.ids[chosen])


class Speed:
    """Distance to the grain's place in the snapshot before over the time between: the same for every kind of dump."""

    def __init__(self, run, height):
        self.LABEL = "speed since the last picture " + (r"($\sqrt{gd}$)" if run.scene else "($d$ per step)")
        self._before = self._now = None

    def see(self, grains):
        self._before, self._now = self._now, grains

    def values(self, grains, chosen):
        unknown = np.full(len(grains.ids[chosen]), math.nan)
        if self._before is None:
            return unknown
        before, places = self._before, np.stack([
            _of_earlier(self._before.ids, axis, grains.ids[chosen]) for axis in self._before.positions.T], axis=1)
        return np.linalg.norm(grains.positions[chosen] - places, axis=1) / (grains.time - before.time)


class PackingFraction:
    """Volume of the grain over that of its Voronoi cell, which the walls of scene.json cut off.

    Unknown at the free surface, at the outlet of a hopper, and at walls where no scene.json tells them or the silo is
    periodic.
    """

    LABEL = "local packing fraction"

    def __init__(self, run, height):
        self._path = run.path
        self._cells = cells_without_walls
        if run.has_front or isinstance(run.container, Hopper):
            cells = cells_in_container if run.has_front else cells_in_hopper
            self._cells = lambda points: cells(points, run.container)

    def see(self, grains):
        sizes = grains.diameters
        if len(sizes) and np.ptp(sizes) > EQUAL * sizes.max():
            raise AnalysisError(f"{self._path}: grains differ in size by more than 1 %, and local packing fractions come from cells "
                                "of equal grains; colour by layer or speed instead")

    def values(self, grains, chosen):
        y = grains.positions[:, 1]
        if not chosen.any():
            return np.empty(0)
        near = (y > y[chosen].min() - MIRRORED) & (y < y[chosen].max() + MIRRORED)
        points = grains.positions[near]
        fractions = math.pi / 6 * grains.diameters[near]**3 / self._cells(points)
        return np.where(fractions > 0, fractions, math.nan)[chosen[near]]


COLOURINGS = {"layer": StartingLayer, "speed": Speed, "packing": PackingFraction}


def _of_earlier(ids, values, wanted):
    """The values (n,) of the grains ``ids`` for those in ``wanted`` (m,); not a number for the others."""
    if not len(ids):
        return np.full(len(wanted), math.nan)
    place = np.searchsorted(ids, wanted).clip(0, len(ids) - 1)
    return np.where(ids[place] == wanted, values[place], math.nan)
