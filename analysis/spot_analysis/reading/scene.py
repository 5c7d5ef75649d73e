# SPDX-License-Identifier: GPL-2.0-or-later
"""What a dump does not say: units and geometry of the run, read from the ``scene.json`` beside the dumps."""

import glob
import os
from dataclasses import MISSING, asdict, dataclass, fields

from ..base.errors import SceneError
from .container import Container, check_orifices
from .json_object import read_object
from .origin import Origin, check_numbers

FILE_NAME = "scene.json"
PERIOD_KEY = "half_period_y"
BOX_KEYS = ("half_width_x", "half_depth_y", PERIOD_KEY)  # one of these tells a box,
HOPPER_KEYS = ("cylinder_radius", "cone_height")  # and of these a hopper, see ``axial_scene``
LEAST_PERIOD = 12.0  # d; twice as far as pairs of grains are looked for


@dataclass(frozen=True)
class Scene(Origin):
    """Units and geometry, in the units of the dump.

    diameter, gravity, timestep : grain diameter d; acceleration g; time of one step of the dumps' TIMESTEP
    half_width_x, half_depth_y : walls at x = axis_x +- half_width_x and y = axis_y +- half_depth_y
    periodic_y : there are no walls across y, along which the silo repeats every 2 half_depth_y; a scene file says so by
        half_period_y in the place of half_depth_y
    orifice_radius : of the circular orifice on the axis, or half of a slot's width
    orifices, slot : how many, in the middles of equal parts of the base along x; whether they go from front to back
    opening_time : when the orifice opens, counted from TIMESTEP 0
    axis_x, axis_y, base_z : where the axis of silo and orifice meets the base
    program, grains : what made the dumps; how many grains there were at the start, None where it was not said
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
    orifices: int = 1
    slot: bool = False

    def __post_init__(self):
        check_numbers(self, NUMBERS, ORIGIN)
        if not isinstance(self.program, str):
            raise SceneError(f"scene: 'program' must be a text, not {self.program!r}")
        check_orifices(self.orifices, self.slot)
        if self.periodic_y and 2 * self.half_depth_y < LEAST_PERIOD * self.diameter:
            raise SceneError(f"scene: '{PERIOD_KEY}' is {self.half_depth_y:g}, half of a period of "
                             f"{2 * self.half_depth_y / self.diameter:g} d, but must be half of {LEAST_PERIOD:g} d or more: no pair "
                             "of grains may be counted twice")

    def container(self):
        """The container in units of d."""
        return Container(self.half_width_x / self.diameter, self.half_depth_y / self.diameter,
                         self.orifice_radius / self.diameter, self.periodic_y, self.orifices)

    def as_dict(self):
        """key -> value, as in a scene file."""
        values = asdict(self)
        if values.pop("periodic_y"):
            values[PERIOD_KEY] = values.pop("half_depth_y")
        return values


KEYS = (*(f.name for f in fields(Scene) if f.name != "periodic_y"), PERIOD_KEY)
NUMBERS = tuple(f.name for f in fields(Scene) if f.type is float and f.default is MISSING)
ORIGIN = tuple(f.name for f in fields(Scene) if f.type is float and f.default is not MISSING)  # of time and space


def load_scene(source, scene_file=None, overrides=None):
    """The scene of the dumps ``source`` (a folder, file or wildcard).

    scene_file : read instead of the ``scene.json`` in the dumps' folder
    overrides : key -> value, wins over the file; None values are ignored

    Raises SceneError if there is no such source, or naming the key that is missing, unknown or bad.
    """
    require_existence(source)
    path = scene_file or path_beside(source)
    values = read_values(path) if scene_file or os.path.exists(path) else {}
    values.update({key: value for key, value in (overrides or {}).items() if value is not None})
    return complete_scene(values, source, path)


def require_existence(source):
    """Raises SceneError where there are no such dumps: a scene file of the folder around them is none of theirs."""
    if not glob.has_magic(os.fspath(source)) and not os.path.exists(source):
        raise SceneError(f"{source}: no such file or folder")


def path_beside(source):
    """Where the scene file of the dumps would be."""
    return os.path.join(source if os.path.isdir(source) else os.path.dirname(source), FILE_NAME)


def read_values(path):
    """Key -> value of a scene file; raises SceneError where it is damaged."""
    return read_object(path, f"the keys {', '.join(NUMBERS)}")


def complete_scene(values, source, path):
    """The Scene of what ``path`` and the command line gave; raises SceneError for a key that is missing or bad."""
    if any(key in values for key in HOPPER_KEYS):
        raise SceneError(f"{path}: the scene is a hopper ({', '.join(HOPPER_KEYS)}), which analysis/hopper.py measures")
    for key in NUMBERS:
        if key not in values and not (key == "half_depth_y" and PERIOD_KEY in values):
            where = f"in {path}" if os.path.exists(path) else f"(no {path})"
            raise SceneError(f"{source}: scene key '{key}' is missing {where}; "
                             f"add it there or give it on the command line")
    try:
        return scene_of(values)
    except SceneError as error:
        raise SceneError(f"{path}: {error}") from error


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
