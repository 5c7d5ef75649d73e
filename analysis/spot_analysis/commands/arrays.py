# SPDX-License-Identifier: GPL-2.0-or-later
"""Statistics and pictures of arrays, without files: what a program calls that has the positions of grains already."""

import numpy as np

from ..base.errors import AnalysisError
from ..reading.frame import Frame
from ..reading.scene import complete_scene
from ..reading.scene_beside import scene_and_walls
from ..rendering.drawing import draw, view_of
from ..rendering.pictures import MIDDLE, Picture, Reel
from ..report import comparison
from ..statistics.interval_view import whole_run
from ..statistics.recorder import Recorder
from ..statistics.run_statistics import CONCEPTS
from ..statistics.scene_fit import require_one_round_orifice

LAYER = 10.0  # d, height of the layers that grains are coloured by


def measure(times, ids, positions, scene):
    """Statistics of a drainage in a box with one round orifice.

    times : (T,) s, increasing, from 0 on, when the orifice opens
    ids : (T, N), or T arrays (N_t,) of whole numbers, each once in a snapshot
    positions : (T, N, 3), or T arrays (N_t, 3), m
    scene : the keys of scene.json but for ``timestep``: diameter, half_width_x, half_depth_y, orifice_radius, m;
        gravity, m/s2

    Returns RunStatistics; ``save(path)`` keeps it as a file that compare.py takes. Any other unit of length and time does
    as well. Raises AnalysisError.

    >>> import numpy as np, spot_analysis
    >>> scene = dict(diameter=0.003, gravity=9.81, half_width_x=0.03, half_depth_y=0.012, orifice_radius=0.036)
    >>> tau = (0.003 / 9.81) ** 0.5
    >>> start = 0.003 * np.array([(x - 9.5, y - 3.5, z + 0.5) for x in range(20) for y in range(8) for z in range(40)])
    >>> fallen = [start - [0, 0, 0.003 * k] for k in range(9)]    # by a layer of 160 grains in 2 tau
    >>> left = [places[:, 2] > 0 for places in fallen]
    >>> run = spot_analysis.measure(2 * tau * np.arange(9), [np.flatnonzero(one) for one in left],
    ...                             [places[one] for places, one in zip(fallen, left)], scene)
    >>> outflow = spot_analysis.numbers(run)["outflow"]
    >>> round(outflow.value, 3), outflow.unit
    (80.0, '1/tau')
    """
    scene = complete_scene({**scene, "timestep": 1.0}, "scene", "scene")
    require_one_round_orifice(scene)
    times = np.asarray(times, dtype=float)
    if times.ndim != 1 or not len(times) or times[0] < 0 or (np.diff(times) <= 0).any() or not np.isfinite(times).all():
        raise AnalysisError("times: must be one or more numbers (T,) from 0 on, each above the one before")
    if not len(times) == len(ids) == len(positions):
        raise AnalysisError(f"{len(times)} times, {len(ids)} arrays of ids, {len(positions)} of positions: must be alike")
    recorder = Recorder(scene, CONCEPTS)
    for index, time in enumerate(times):
        recorder.add(_frame(index, time, ids[index], positions[index]))
    return recorder.statistics({"source": "arrays"})


def _frame(index, time, ids, positions):
    """As of a dump whose step takes 1 s; raises AnalysisError."""
    ids, positions = np.asarray(ids), _places(f"positions[{index}]", positions)
    if ids.shape != positions.shape[:1] or ids.dtype.kind not in "iu" and len(ids):
        raise AnalysisError(f"ids[{index}]: must be {len(positions)} whole numbers, one for each position")
    order = np.argsort(ids, kind="stable")
    ids = ids[order].astype(np.int64)
    if (np.diff(ids) == 0).any():
        raise AnalysisError(f"ids[{index}]: {ids[1:][np.diff(ids) == 0][0]} stands there twice")
    return Frame(time, ids, positions[order], None)


def _places(name, positions):
    positions = np.asarray(positions, dtype=float)
    if positions.ndim != 2 or positions.shape[1] != 3 or not np.isfinite(positions).all():
        raise AnalysisError(f"{name}: must be finite numbers (N, 3), but its shape is {positions.shape}")
    return positions


def numbers(run):
    """The numbers of RunStatistics in d, tau, grains: name -> Value, with unit, value and error, None where unknown."""
    return comparison.quantities(whole_run(run))


def picture(positions, scene, slab=(-MIDDLE, MIDDLE), heights=None, height=600):
    """A slice of a packing as a PIL.Image, seen along y, in the colours of layers 10 d high.

    positions : (N, 3) m; scene : as in ``measure``, or for a hopper orifice_radius, cylinder_radius and cone_height, m;
        of another silo diameter and gravity alone, and no walls are drawn
    slab : (low, high) of y, d
    heights : (N,) m, at which the grains started, for the colours; None: they are there now
    height : of the picture, pixels
    """
    scene, walls = scene_and_walls({**scene, "timestep": 1.0}, "scene", "scene")
    places = scene.positions(_places("positions", positions))
    start = places[:, 2] if heights is None else (np.asarray(heights, dtype=float) - scene.base_z) / scene.diameter
    if start.shape != places.shape[:1]:
        raise AnalysisError(f"heights: must be {len(places)} numbers, one for each position")
    chosen = (places[:, 1] >= slab[0]) & (places[:, 1] < slab[1])
    if not chosen.any():
        raise AnalysisError(f"slab: no grain between y = {slab[0]:g} and {slab[1]:g} d")
    order = np.flatnonzero(chosen)[np.argsort(-places[chosen, 1], kind="stable")]  # the far ones first
    layers = np.floor(np.maximum(start[order], 0) / LAYER)
    drawn = Picture(0.0, *places[order][:, [0, 2]].T, np.ones(len(order)), layers)
    walls = walls and walls.cut(slab)
    view = view_of([Reel("", "layer", None, walls, True, [drawn])], [[drawn]], height, None, None)
    return draw([("", drawn, walls, None)], view, "layer")
