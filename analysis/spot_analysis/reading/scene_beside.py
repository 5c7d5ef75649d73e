# SPDX-License-Identifier: GPL-2.0-or-later
"""The scene of dumps that may have none, or one of another shape: all that is known of it."""

import os

from ..base.errors import SceneError
from .axial_scene import AxialScene
from .hopper import Hopper
from .scene import BOX_KEYS, KEYS, complete_scene, path_beside, read_values

WALLS = ("half_width_x", "half_depth_y", "orifice_radius")
HOPPER = ("orifice_radius", "cylinder_radius", "cone_height")
UNITS = ("diameter", "gravity", "timestep")


def scene_beside(source):
    """The scene of ``source``, None where there is no ``scene.json``; its walls in d: a Container, a Hopper, or None.

    Of a silo that is no box only units and origin are in the scene. Raises SceneError where the file is bad.
    """
    path = path_beside(source)
    if not os.path.exists(path):
        return None, None
    return scene_and_walls(read_values(path), source, path)


def scene_and_walls(values, source, path):
    """The same of key -> value; source, path : for errors."""
    is_box = any(key in values for key in BOX_KEYS)
    hopper = _hopper(values, path)
    if not is_box:
        values = {key: value for key, value in values.items() if key in KEYS and key not in WALLS}
        values.update(dict.fromkeys(WALLS, 1.0))  # a Scene wants them; the caller knows that there are none
    scene = complete_scene(values, source, path)
    return scene, scene.container() if is_box else hopper


def _hopper(values, path):
    """Of the values of a scene file, None where they are those of another silo; raises SceneError where one is bad."""
    if not all(key in values for key in (*HOPPER, *UNITS)):
        return None
    try:
        scene = AxialScene(**{key: values[key] for key in (*HOPPER, *UNITS)})
    except SceneError as error:
        raise SceneError(f"{path}: {error}") from error
    return Hopper(*(getattr(scene, key) / scene.diameter for key in HOPPER))
