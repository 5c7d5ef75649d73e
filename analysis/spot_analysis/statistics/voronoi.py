# SPDX-License-Identifier: GPL-2.0-or-later
"""Local packing fraction: pi/6 over the volume of a grain's Voronoi cell; lengths in d."""

import math

import numpy as np

from .snapshot import TIME_TOLERANCE
from .value import Value
from .voronoi_cells import cells_in_container

NAME = "voronoi"
PERIOD = 10.0  # tau between two packings whose cells are made
MAP_CELL = 2.0  # d
MAP_TOP = 70.0  # d
GRAIN = math.pi / 6
FILLED = 20  # grains in a cell of the map; 35 in flow, with walls 8 d apart
AXIS = 4.0  # d from the axis
SHOULDER = (0.48, 0.64)  # |x| over half_width where the flow is sheared: 12-16 d in the silo of 2006
DIFFERENCE = (24.0, 68.0)  # d; heights over which axis and shoulder are compared
PROFILE = (4.0, 70.0)  # d; heights of the profile on the axis
MEANING = {
    "voronoi_fraction": "mean over grains of pi/6 over cell volume",
    "voronoi_fraction_spread": "its standard deviation over grains",
    "voronoi_map_rms": "rms difference of the maps, cells of 2 d",
    "packing_axis_less_shoulder": "on the axis less where the flow is sheared, z = 24-68 d",
    "packing_profile_rms": "rms difference along the axis, z = 4-70 d",
}
NEEDS = {"packing_*": ("cells", "filled"), "*": ("cells", "structure")}


class Measurement:
    """x_edges, z_edges of the map; times (V,); map_grains, map_volumes (V, X, Z): grains and their cells' volume;
    mean, spread (V,): mean and standard deviation of pi/6 over cell volume in the structure region."""

    def __init__(self, container, region):
        self._container, self._region = container, region
        bins = max(int(2 * container.half_width / MAP_CELL + 0.5), 1)
        self._x = np.linspace(-1, 1, bins + 1) * container.half_width
        self._z = np.arange(0, MAP_TOP + MAP_CELL / 2, MAP_CELL)
        self._rows = []

    def add(self, snapshot, history):
        if abs(snapshot.time - PERIOD * round(snapshot.time / PERIOD)) > TIME_TOLERANCE:
            return
        positions = snapshot.positions[snapshot.positions[:, 2] < MAP_TOP + 3]
        volumes = cells_in_container(positions, self._container)
        closed = np.isfinite(volumes) & (positions[:, 2] < MAP_TOP)
        place = positions[closed][:, [0, 2]].T
        grains = np.histogram2d(*place, (self._x, self._z))[0].astype(np.int64)
        total = np.histogram2d(*place, (self._x, self._z), weights=volumes[closed])[0]
        local = GRAIN / volumes[closed & self._region.contains(positions)]
        known = snapshot.is_covered and len(local) > 1
        self._rows.append((snapshot.time, grains, total, local.mean() if known else math.nan,
                           local.std() if known else math.nan))

    def arrays(self):
        shape = (0, len(self._x) - 1, len(self._z) - 1)
        columns = list(zip(*self._rows)) or [[], np.empty(shape, dtype=np.int64), np.empty(shape), [], []]
        names = ("times", "map_grains", "map_volumes", "mean", "spread")
        return {"x_edges": self._x, "z_edges": self._z,
                **{name: np.array(column) for name, column in zip(names, columns)}}


def mean_map(view):
    """Packing fraction (X, Z) over the interval, not a number where there are few grains; None without data."""
    part = view.run.measured[NAME]
    rows = view.rows(part.times)
    if not len(rows):
        return None
    grains, volumes = part.map_grains[rows].sum(axis=0), part.map_volumes[rows].sum(axis=0)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(grains >= 10 * len(rows), GRAIN * grains / volumes, np.nan)


def _places(part):
    """Columns of the map on the axis and in the shoulders, (X,) bool each."""
    x = np.abs(part.x_edges[1:] + part.x_edges[:-1]) / 2
    low, high = (share * part.x_edges[-1] for share in SHOULDER)
    return x < AXIS, (x >= low - 1e-9) & (x <= high + 1e-9)


def _filled(part, rows, columns, span):
    """(Z,) bool: heights of the map within ``span`` at which all cells of ``columns`` are filled in all of ``rows``."""
    within = (part.z_edges[:-1] > span[0] - 1e-9) & (part.z_edges[1:] < span[1] + 1e-9)
    return within & (part.map_grains[np.ix_(rows, columns)] >= FILLED).all(axis=(0, 1))


def axis_profile(view):
    """Packing fraction on the axis over the interval, (Z,); not a number at heights that it does not fill. None without data."""
    part = view.run.measured[NAME]
    rows, axis = view.rows(part.times), _places(part)[0]
    if not len(rows):
        return None
    filled = _filled(part, rows, np.flatnonzero(axis), PROFILE)
    grains, volumes = (array[rows][:, axis].sum(axis=(0, 1)) for array in (part.map_grains, part.map_volumes))
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(filled, GRAIN * grains / volumes, np.nan)


def _axis_less_shoulder(view):
    part = view.run.measured[NAME]
    axis, shoulder = _places(part)
    heights = _filled(part, view.rows(part.times), np.flatnonzero(axis | shoulder), DIFFERENCE)
    columns = np.column_stack([array[:, place][:, :, heights].sum(axis=(1, 2)) for place in (axis, shoulder)
                               for array in (part.map_grains, part.map_volumes)])

    def difference(sums):
        with np.errstate(invalid="ignore", divide="ignore"):
            return GRAIN * (sums[..., 0] / sums[..., 1] - sums[..., 2] / sums[..., 3])

    return view.estimate("1", part.times, columns, difference)


def quantities(view):
    part = view.run.measured[NAME]
    return {"voronoi_fraction": view.mean_of("1", part.times, part.mean),
            "voronoi_fraction_spread": view.mean_of("1", part.times, part.spread),
            "packing_axis_less_shoulder": _axis_less_shoulder(view)}


def _rms(one, other):
    """Root mean square of the difference of two arrays, where both are known."""
    if one is None or other is None or not np.isfinite(one - other).any():
        return Value("1")
    return Value.of("1", np.sqrt(np.nanmean((one - other)**2)))


def between(dem, spot):
    """Root mean squares of the difference of the two maps, and of the two profiles."""
    return {"voronoi_map_rms": _rms(mean_map(dem), mean_map(spot)),
            "packing_profile_rms": _rms(axis_profile(dem), axis_profile(spot))}
