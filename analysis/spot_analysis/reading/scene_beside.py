# SPDX-License-Identifier: GPL-2.0-or-later
"""The scene of dumps that may have none, or one of another shape: all that is known of it."""

import os

from .scene import BOX_KEYS, KEYS, complete_scene, path_beside, read_values

WALLS = ("half_width_x", "half_depth_y", "orifice_radius")


def scene_beside(source):
    """The scene of ``source``, and whether it tells the walls of a box; (None, False) where there is no ``scene.json``.

    Of a silo of another shape, such as a hopper, only units and origin are taken. Raises SceneError where the file is bad.
    """
    path = path_beside(source)
    if not os.path.exists(path):
        return None, False
    values = read_values(path)
    is_box = any(key in values for key in BOX_KEYS)
    if not is_box:
        values = {key: value for key, value in values.items() if key in KEYS and key not in WALLS}
        values.update(dict.fromkeys(WALLS, 1.0))  # a Scene wants them; the caller knows that there are none
    return complete_scene(values, source, path), is_box
