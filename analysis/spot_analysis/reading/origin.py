# SPDX-License-Identifier: GPL-2.0-or-later
"""What scenes of any shape have in common: units, and from where time and places count."""

import math

import numpy as np

from ..base.errors import SceneError


class Origin:
    """Of a scene with diameter, gravity and timestep, opening_time, axis_x, axis_y and base_z, in the units of the
    dump."""

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


def check_numbers(scene, positive, finite):
    """Raises SceneError for what is no number; positive, finite : keys whose values have to be that."""
    for key in positive:
        if not _is_finite(getattr(scene, key)) or getattr(scene, key) <= 0:
            raise SceneError(f"scene: '{key}' must be a positive number, not {getattr(scene, key)!r}")
    for key in finite:
        if not _is_finite(getattr(scene, key)):
            raise SceneError(f"scene: '{key}' must be a number, not {getattr(scene, key)!r}")


def _is_finite(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value)
