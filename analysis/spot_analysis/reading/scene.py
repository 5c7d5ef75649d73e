# SPDX-License-Identifier: GPL-2.0-or-later
"""What a dump does not say: units and geometry of the run."""

import math
from dataclasses import MISSING, asdict, dataclass, fields

import numpy as np

from ..base.errors import SceneError
from .container import Container

PERIOD_KEY = "half_period_y"
LEAST_PERIOD = 12.0  # d; twice as far as pairs of grains are looked for


@dataclass(frozen=True)
class Scene:
    """Units and geometry, in the units of the dump.

    diameter : grain diameter d
    gravity : acceleration g
    timestep : time of one step of the dumps' TIMESTEP
    half_width_x, half_depth_y : walls at x = axis_x +- half_width_x and y = axis_y +- half_depth_y
    periodic_y : there are no walls across y, along which the silo repeats every 2 half_depth_y; a scene file says so by
        half_period_y in the place of half_depth_y
    orifice_radius : of the circular orifice on the axis
    opening_time : when the orifice opens, counted from TIMESTEP 0
    axis_x, axis_y, base_z : where the axis of silo and orifice meets the base
    program : what made the dumps
    grains : how many there were at the start, None where it was not said
    """

    diameter: float
    gravity: float
    timestep: float
    half_width_x: float
    half_depth_y: float
    orifice_radius: float
    opening_time: float = 0.0
    axis_x: float = 0.0
    axis_y: float = 0.0
    base_z: float = 0.0
    program: str = "unknown"
    grains: int = None
    periodic_y: bool = False

    def __post_init__(self):
        for key in NUMBERS:
            if not _is_finite(getattr(self, key)) or getattr(self, key) <= 0:
                raise SceneError(f"scene: '{key}' must be a positive number, not {getattr(self, key)!r}")
        for key in ORIGIN:
            if not _is_finite(getattr(self, key)):
                raise SceneError(f"scene: '{key}' must be a number, not {getattr(self, key)!r}")
        if not isinstance(self.program, str):
            raise SceneError(f"scene: 'program' must be a text, not {self.program!r}")
        if self.periodic_y and 2 * self.half_depth_y < LEAST_PERIOD * self.diameter:
            raise SceneError(f"scene: '{PERIOD_KEY}' is {self.half_depth_y:g}, half of a period of "
                             f"{2 * self.half_depth_y / self.diameter:g} d, but must be half of {LEAST_PERIOD:g} d or more: "
                             f"no pair of grains may be counted twice")

    @property
    def tau(self):
        """sqrt(d/g) in the dump's unit of time."""
        return math.sqrt(self.diameter / self.gravity)

    def time(self, timestep):
        """Time since the orifice was opened, in tau."""
        return (timestep * self.timestep - self.opening_time) / self.tau

    def positions(self, positions):
        """Positions (n, 3) of a dump in d, from where the axis meets the base."""
        return (positions - np.array([self.axis_x, self.axis_y, self.base_z])) / self.diameter

    def container(self):
        """The container in units of d."""
        return Container(self.half_width_x / self.diameter, self.half_depth_y / self.diameter,
                         self.orifice_radius / self.diameter, self.periodic_y)

    def as_dict(self):
        """key -> value, as in a scene file."""
        values = asdict(self)
        if values.pop("periodic_y"):
            values[PERIOD_KEY] = values.pop("half_depth_y")
        return values


def _is_finite(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)


KEYS = (*(f.name for f in fields(Scene) if f.name != "periodic_y"), PERIOD_KEY)
NUMBERS = tuple(f.name for f in fields(Scene) if f.type is float and f.default is MISSING)
WALLS = ("half_width_x", "half_depth_y", "orifice_radius")
ORIGIN = tuple(f.name for f in fields(Scene) if f.type is float and f.default is not MISSING)  # of time and space


def scene_of(values):
    """The Scene of key -> value; raises SceneError for a key that is unknown or bad: it would change what the others mean."""
    unknown = ", ".join(f"'{key}'" for key in values if key not in KEYS)
    if unknown:
        raise SceneError(f"unknown scene key {unknown}; allowed are {', '.join(KEYS)}")
    if PERIOD_KEY not in values:
        return Scene(**values)
    if "half_depth_y" in values:
        raise SceneError(f"scene: both 'half_depth_y' and '{PERIOD_KEY}' are given, but there are walls across y or a period")
    values = dict(values)
    return Scene(half_depth_y=values.pop(PERIOD_KEY), periodic_y=True, **values)
