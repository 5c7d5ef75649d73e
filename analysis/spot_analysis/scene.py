# SPDX-License-Identifier: GPL-2.0-or-later
"""What a dump does not say: units and geometry of the run, read from the ``scene.json`` beside the dumps."""

import glob
import json
import math
import os
from dataclasses import asdict, dataclass, fields

from .container import Container
from .errors import SceneError

FILE_NAME = "scene.json"


@dataclass(frozen=True)
class Scene:
    """Units and geometry, in the units of the dump.

    diameter : grain diameter d
    gravity : acceleration g
    timestep : time of one step of the dumps' TIMESTEP, which counts from the opening of the orifice
    half_width_x, half_depth_y : walls at x = +-half_width_x and y = +-half_depth_y; the base is z = 0
    orifice_radius : of the circular orifice at the origin
    program : what made the dumps
    grains : how many there were at the start, None where it was not said
    """

    diameter: float
    gravity: float
    timestep: float
    half_width_x: float
    half_depth_y: float
    orifice_radius: float
    program: str = "unknown"
    grains: int = None

    def __post_init__(self):
        for key in NUMBERS:
            value = getattr(self, key)
            if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0 < value < math.inf:
                raise SceneError(f"scene: '{key}' must be a positive number, not {value!r}")

    @property
    def tau(self):
        """sqrt(d/g) in the dump's unit of time."""
        return math.sqrt(self.diameter / self.gravity)

    def time(self, timestep):
        """Time since the orifice was opened, in tau."""
        return timestep * self.timestep / self.tau

    def container(self):
        """The container in units of d."""
        return Container(self.half_width_x / self.diameter, self.half_depth_y / self.diameter,
                         self.orifice_radius / self.diameter)

    def as_dict(self):
        return asdict(self)


NUMBERS = tuple(f.name for f in fields(Scene) if f.type is float)


def load_scene(source, scene_file=None, overrides=None):
    """The scene of the dumps ``source`` (a folder, file or wildcard).

    scene_file : read instead of the ``scene.json`` in the dumps' folder
    overrides : key -> value, wins over the file; None values are ignored

    Raises SceneError if there is no such source, or naming the missing or misspelt key.
    """
    if not glob.has_magic(source) and not os.path.exists(source):
        raise SceneError(f"{source}: no such file or folder")
    path = scene_file or os.path.join(source if os.path.isdir(source) else os.path.dirname(source), FILE_NAME)
    values = _read_json(path) if scene_file or os.path.exists(path) else {}
    values.update({key: value for key, value in (overrides or {}).items() if value is not None})
    for key in NUMBERS:
        if key not in values:
            where = f"in {path}" if os.path.exists(path) else f"(no {path})"
            raise SceneError(f"{source}: scene key '{key}' is missing {where}; "
                             f"add it there or give it on the command line")
    known = [f.name for f in fields(Scene)]
    try:
        return Scene(**{key: values[key] for key in known if key in values})
    except SceneError as error:
        raise SceneError(f"{path}: {error}") from error


def _read_json(path):
    try:
        with open(path, encoding="utf-8") as handle:
            values = json.load(handle)
    except OSError as error:
        raise SceneError(f"{path}: {error.strerror}") from error
    except ValueError as error:
        raise SceneError(f"{path}: not valid JSON ({error})") from error
    if not isinstance(values, dict):
        raise SceneError(f"{path}: wants an object with the keys {', '.join(NUMBERS)}")
    return values
