# SPDX-License-Identifier: GPL-2.0-or-later
"""A run as it is drawn: its snapshots in units of d, with or without a scene."""

import os
import warnings
from dataclasses import dataclass

import numpy as np

from ..base.errors import AnalysisError
from ..reading.container import Container
from ..reading.dump import read_frames
from ..reading.scene_beside import scene_beside
from ..reading.spots import read_spots

SIZES = ("radius", "diameter")  # columns of a dump


@dataclass(frozen=True)
class Grains:
    """One snapshot in units of d, n grains.

    step : TIMESTEP of the dump
    time : in tau since the orifice opened; the TIMESTEP where no scene.json tells the units
    ids : (n,) ascending; positions : (n, 3); diameters : (n,)
    spots : (m, 3) positions of live spots
    """

    step: int
    time: float
    ids: np.ndarray
    positions: np.ndarray
    diameters: np.ndarray
    spots: np.ndarray


class Run:
    """Dumps of a folder, file or wildcard.

    label : its title
    path : of the dumps
    container : its walls in units of d, a Container or a Hopper; None where no scene.json tells them
    diameter : d in the dumps' units where no scene.json tells it; None takes the median of the first snapshot's column
        radius or diameter
    """

    def __init__(self, label, path, diameter=None, warn=warnings.warn):
        self.label = label
        self.path = path
        self.scene, self.container = scene_beside(path)
        self._diameter = self.scene.diameter if self.scene else diameter
        self._warn = warn

    @property
    def has_front(self):
        """Whether there are walls at the front and at the back."""
        return isinstance(self.container, Container) and not self.container.periodic

    def snapshots(self):
        """Grains of each snapshot in the order of time; raises DumpError."""
        folder = self.path if os.path.isdir(self.path) else os.path.dirname(self.path) or "."
        spots = read_spots(folder)
        for frame in read_frames(self.path, SIZES, self._warn):
            time = self.scene.time(frame.timestep) if self.scene else frame.timestep
            if time < 0 and self.scene:
                continue
            sizes = self._sizes(frame)
            here = spots.get(frame.timestep, np.empty((0, 3)))
            yield Grains(frame.timestep, time, frame.ids, self._in_d(frame.positions), sizes / self._diameter, self._in_d(here))

    def _sizes(self, frame):
        """Diameters (n,) in the dump's units."""
        factors = {"radius": 2, "diameter": 1}
        known = next((factors[name] * frame.extra[name] for name in SIZES if name in frame.extra), None)
        if self._diameter is None and known is not None and len(known):
            self._diameter = float(np.median(known))
        if self._diameter is None:
            raise AnalysisError(f"{self.path}: the grains' diameter is not known: no scene.json beside the dumps, and no column "
                                "radius or diameter in them; give it as --diameter, in the dumps' units")
        return np.full(len(frame.ids), self._diameter) if known is None else known

    def _in_d(self, positions):
        return self.scene.positions(positions) if self.scene else positions / self._diameter
