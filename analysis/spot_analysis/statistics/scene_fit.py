# SPDX-License-Identifier: GPL-2.0-or-later
"""Whether the scene fits the dumps: a wrong one makes every number wrong."""

import math

import numpy as np

from ..base.errors import SceneError
from .passages import JUMP, common, snapshots_of

STRAY = 10  # grains; fewer may be somewhere else for a while, as one that has come through a wall
BASE_GAP = 1.0  # d; centres of grains at rest on a base are lower


def require_diameter(scene, frame):
    """Raises SceneError where grains cannot have the scene's diameter: a wrong one makes every number wrong."""
    diameter = scene.diameter
    radius = frame.extra.get("radius")
    if radius is not None and np.any(np.abs(2 * radius / diameter - 1) > 1e-3):
        odd = np.argmax(np.abs(2 * radius / diameter - 1))
        raise SceneError(f"grain {frame.ids[odd]} has radius {radius[odd]:g}, "
                         f"but the scene's diameter is {diameter:g}; "
                         "grains of unequal size are for mixture.py, in boxes")
    if len(frame.ids) < 2:
        return
    extent = np.ptp(frame.positions, axis=0) + diameter
    if len(frame.ids) * math.pi / 6 * diameter**3 > extent.prod():
        raise SceneError(f"the scene's diameter {diameter:g} does not fit the dump: {len(frame.ids)} such grains "
                         f"have more volume than the box of {extent[0]:.3g} x {extent[1]:.3g} x {extent[2]:.3g} "
                         "they lie in")


def once_through(source, frames, scene):
    """The Frames of ``source``, as long as no grains go round; raises SceneError where they do: rates and velocities
    would be wrong.

    They are counted by the dumps, or more than ``STRAY`` have risen as grains never do by themselves."""
    last, risen = None, 0
    for frame in frames:
        (latest,) = snapshots_of([frame], scene)
        if last is not None:
            first, second = common(last, latest)
            risen += np.count_nonzero(latest.positions[second, 2] - last.positions[first, 2] > JUMP)
        if latest.rounds.any() or risen > STRAY:
            most = max(np.count_nonzero(latest.rounds), risen)
            raise SceneError(f"{source}: {most} grains have gone round by step {frame.timestep}; "
                             "hopper.py and box.py in analysis measure grains that come in again")
        last = latest
        yield frame


def warn_of_misfit(source, run, lowest, warn):
    """Grains outside the walls, or a first snapshot that ends far above the base, mean another scene than that of the dumps."""
    if run.outside.max() > 0:
        most = int(run.outside.argmax())
        warn(f"{source}: {run.outside[most]} of {run.grains[most]} grains are outside the walls and the base of the scene at "
             f"t = {run.times[most]:g} tau")
    if BASE_GAP < lowest < math.inf:
        warn(f"{source}: the lowest grain of the first snapshot lies {lowest:g} d above the base of the scene, from which all "
             "heights count; 'base_z' says where the base is")


def require_one_round_orifice(scene):
    """Raises SceneError for a silo that only box.py measures."""
    if scene.orifices > 1 or scene.slot:
        raise SceneError("scene: this measures a silo with one round orifice; analysis/box.py takes several, "
                         "and slots, of equal grains")
