# SPDX-License-Identifier: GPL-2.0-or-later
"""The scene of a run, read from the ``scene.json`` beside its dumps."""

import glob
import os

from ..base.errors import SceneError
from .json_object import read_object
from .scene import NUMBERS, PERIOD_KEY, WALLS, scene_of

FILE_NAME = "scene.json"


def load_scene(source, scene_file=None, overrides=None):
    """The scene of the dumps ``source`` (a folder, file or wildcard).

    scene_file : read instead of the ``scene.json`` in the dumps' folder
    overrides : key -> value, wins over the file; None values are ignored

    Raises SceneError if there is no such source, or naming the key that is missing, unknown or bad.
    """
    if not glob.has_magic(source) and not os.path.exists(source):
        raise SceneError(f"{source}: no such file or folder")
    path = scene_file or _path_beside(source)
    values = _read(path) if scene_file or os.path.exists(path) else {}
    values.update({key: value for key, value in (overrides or {}).items() if value is not None})
    return _complete(values, source, path)


def scene_beside(source):
    """The scene of ``source``, and whether it tells walls.

    (None, False) where there is no ``scene.json``. One without any of WALLS has units only. Raises SceneError where it is bad.
    """
    path = _path_beside(source)
    if not os.path.exists(path):
        return None, False
    values = _read(path)
    walls = any(key in values for key in (*WALLS, PERIOD_KEY))
    if not walls:
        values.update(dict.fromkeys(WALLS, 1.0))  # a Scene wants them; the caller knows that there are none
    return _complete(values, source, path), walls


def _path_beside(source):
    return os.path.join(source if os.path.isdir(source) else os.path.dirname(source), FILE_NAME)


def _read(path):
    return read_object(path, f"the keys {', '.join(NUMBERS)}")


def _complete(values, source, path):
    """The Scene of what ``path`` and the command line gave; raises SceneError for a key that is missing or bad."""
    for key in NUMBERS:
        if key not in values and not (key == "half_depth_y" and PERIOD_KEY in values):
            where = f"in {path}" if os.path.exists(path) else f"(no {path})"
            raise SceneError(f"{source}: scene key '{key}' is missing {where}; "
                             f"add it there or give it on the command line")
    try:
        return scene_of(values)
    except SceneError as error:
        raise SceneError(f"{path}: {error}") from error
