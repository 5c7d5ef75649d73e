# SPDX-License-Identifier: GPL-2.0-or-later
"""A hopper that is round about a vertical axis: a cone under an upright cylinder, as ``scene.json`` beside the dumps tells it."""

from dataclasses import MISSING, dataclass, fields

import numpy as np

from ..base.errors import SceneError
from .json_object import read_object
from .origin import Origin, check_numbers
from .scene import BOX_KEYS, path_beside, require_existence


@dataclass(frozen=True)
class AxialScene(Origin):
    """Lengths and times in the units of the dump; the axis is vertical and the outlet lies at its lower end.

    diameter, gravity, timestep, opening_time, axis_x, axis_y, base_z, program, grains : as in ``Scene``
    orifice_radius, cylinder_radius : of the cone's ends
    cone_height : from the outlet to where the cone ends and the cylinder begins
    """

    diameter: float
    gravity: float
    timestep: float
    orifice_radius: float
    cylinder_radius: float
    cone_height: float
    opening_time: float = 0.0
    axis_x: float = 0.0
    axis_y: float = 0.0
    base_z: float = 0.0
    program: str = "unknown"
    grains: int = None

    def __post_init__(self):
        check_numbers(self, NUMBERS, ORIGIN)
        if self.orifice_radius >= self.cylinder_radius:
            raise SceneError("scene: 'orifice_radius' must be below 'cylinder_radius'")

    def radius_at(self, height):
        """Radius of the inside at heights, an array of any shape, both in d; that of the outlet below it."""
        rim, side, shoulder = (length / self.diameter for length in (self.orifice_radius, self.cylinder_radius, self.cone_height))
        return np.minimum(side, rim + (side - rim) * np.maximum(height, 0.0) / shoulder)


NUMBERS = tuple(f.name for f in fields(AxialScene) if f.type is float and f.default is MISSING)
ORIGIN = tuple(f.name for f in fields(AxialScene) if f.type is float and f.default is not MISSING)  # of time and space
# The last follows from the others; decks of LIGGGHTS write it.
KEYS = (*(f.name for f in fields(AxialScene)), "cone_angle")


def load_axial_scene(source):
    """The scene of the dumps ``source`` (a folder, file or wildcard); raises SceneError naming the file, and what is
    missing, unknown or bad."""
    require_existence(source)
    path = path_beside(source)
    values = read_object(path, f"the keys {', '.join(NUMBERS)}")
    missing = [name for name in NUMBERS if name not in values]
    if missing and any(key in values for key in BOX_KEYS):
        raise SceneError(f"{path}: no hopper, '{missing[0]}' is missing; the scene is a box, which "
                         "analysis/box.py measures, mixture.py with two sizes")
    if missing:
        raise SceneError(f"{path}: no hopper, '{missing[0]}' is missing")
    unknown = [key for key in values if key not in KEYS]
    if unknown:  # it would change what the others mean
        raise SceneError(f"{path}: unknown scene key '{unknown[0]}'; those of a hopper are {', '.join(KEYS)}")
    values.pop("cone_angle", None)
    try:
        return AxialScene(**values)
    except SceneError as error:
        raise SceneError(f"{path}: {error}") from error
