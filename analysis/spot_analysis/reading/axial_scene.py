# SPDX-License-Identifier: GPL-2.0-or-later
"""A hopper that is round about a vertical axis: a cone under an upright cylinder, as ``scene.json`` beside the dumps tells it."""

import math
import os
from dataclasses import dataclass, fields

from ..base.errors import SceneError
from .json_object import read_object
from .scene import FILE_NAME


@dataclass(frozen=True)
class AxialScene:
    """Lengths and times in the units of the dump; the axis is x = y = 0 and the outlet lies at z = 0.

    diameter, gravity, timestep : as in ``Scene``
    orifice_radius, cylinder_radius : of the cone's ends
    cone_height : where the cone ends and the cylinder begins
    """

    diameter: float
    gravity: float
    timestep: float
    orifice_radius: float
    cylinder_radius: float
    cone_height: float

    def __post_init__(self):
        for field in fields(self):
            value = getattr(self, field.name)
            if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value) or value <= 0:
                raise SceneError(f"scene: '{field.name}' must be a positive number, not {value!r}")
        if self.orifice_radius >= self.cylinder_radius:
            raise SceneError("scene: 'orifice_radius' must be below 'cylinder_radius'")

    @property
    def tau(self):
        """sqrt(d/g) in the dump's unit of time."""
        return math.sqrt(self.diameter / self.gravity)

    def radius_at(self, height):
        """Radius of the inside at a height, both in d."""
        rim, side, shoulder = (length / self.diameter for length in (self.orifice_radius, self.cylinder_radius, self.cone_height))
        return min(side, rim + (side - rim) * height / shoulder)


def load_axial_scene(folder):
    """The scene beside the dumps in ``folder``; raises SceneError naming the file and what is missing."""
    path = os.path.join(folder, FILE_NAME)
    names = [field.name for field in fields(AxialScene)]
    values = read_object(path, f"the keys {', '.join(names)}")
    missing = [name for name in names if name not in values]
    if missing:
        raise SceneError(f"{path}: no hopper, '{missing[0]}' is missing")
    return AxialScene(**{name: values[name] for name in names})
