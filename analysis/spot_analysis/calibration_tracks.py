# SPDX-License-Identifier: GPL-2.0-or-later
"""The paths of all grains through an interval of steady flow, and the packing they started from."""

from dataclasses import dataclass, replace

import numpy as np

from .bootstrap import BLOCK_TAU, MINIMUM_BLOCKS
from .calibration_estimate import CalibrationError
from .container import Container
from .dump import find_dumps, read_frames
from .interval import STEADY_FROM
from .progress import Progress
from .snapshot import LAG_TAU, TIME_TOLERANCE

CORE_HALF_WIDTH = 8.0  # d; 2006 takes its correlations from a core 16 d wide
WALL_LAYER = 1.5  # d, between the walls in y and the core
CORE_HEIGHT = 16.0
CORE_TOP = 66.0
CORE_BOTTOM = 25.0  # lower down streamlines converge too fast to take the mean flow out
SURFACE_MARGIN = 8.0  # d between the core and the surface: R_s and the loose layer on top


@dataclass(frozen=True)
class Tracks:
    """Snapshots LAG_TAU apart; units d and tau.

    container : Container
    times : (T,)
    positions : (T, n, 3), one column a grain, not a number once it has left the dump
    initial : (m, 3), the packing at rest
    early_times, early_heights : every snapshot up to the last of ``times``, and the heights z of its grains
    """

    container: Container
    times: np.ndarray
    positions: np.ndarray
    initial: np.ndarray
    early_times: np.ndarray
    early_heights: list

    @property
    def span(self):
        return float(self.times[0]), float(self.times[-1])

    @property
    def step_times(self):
        """(T - 1,) middles of the steps from one snapshot to the next."""
        return (self.times[1:] + self.times[:-1]) / 2

    def frame(self, index):
        """(m, 3) positions of the grains that are in snapshot number ``index``."""
        positions = self.positions[index]
        return positions[np.isfinite(positions[:, 2])]


@dataclass(frozen=True)
class Core:
    """|x| < half_width, |y| < half_depth, bottom < z < top: where fluctuations are measured, far from orifice and surface.

    The layer of grains at the walls is left out: in DEM it rolls along them, with four times the variance, and each of
    its grains by itself, which no spot describes.
    """

    half_width: float
    half_depth: float
    bottom: float
    top: float

    def contains(self, positions, margin=0.0):
        """(...) bool: centres inside, or within ``margin`` along x, y and below."""
        x, y, z = (positions[..., axis] for axis in range(3))
        return ((np.abs(x) < self.half_width + margin) & (np.abs(y) < self.half_depth + margin)
                & (z > self.bottom - margin) & (z < self.top))

    def upper(self):
        """Its uppermost CORE_HEIGHT, the region of C(r)."""
        return replace(self, bottom=self.top - CORE_HEIGHT)


def read_tracks(source, scene, start=None, end=None, warn=print):
    """Read the dumps ``source`` (see ``dump.find_dumps``).

    start, end : interval in tau; without ``start`` the longest stretch from STEADY_FROM on with a snapshot every LAG_TAU

    Raises DumpError, and CalibrationError where the snapshots cannot carry a calibration.
    """
    files = len(find_dumps(source))
    progress = Progress("reading")
    times, frames = [], []
    for number, frame in enumerate(read_frames(source, warn=warn), 1):
        times.append(round(scene.time(frame.timestep), 6))
        frames.append((frame.ids, frame.positions / scene.diameter))
        progress(f"{number} of {files} files, t = {times[-1]:g} tau")
    times = np.array(times)
    if abs(times[0]) > TIME_TOLERANCE:
        raise CalibrationError(f"the first snapshot is at t = {times[0]:g} tau; v_s needs the packing at rest, t = 0")
    chosen = choose_snapshots(times, start, end)
    progress.finish(f"{len(times)} snapshots; calibrating on {len(chosen)}, {times[chosen[0]]:g} to "
                    f"{times[chosen[-1]]:g} tau")
    ids = np.unique(np.concatenate([frames[index][0] for index in chosen]))
    positions = np.full((len(chosen), len(ids), 3), np.nan)
    for row, index in enumerate(chosen):
        positions[row, np.searchsorted(ids, frames[index][0])] = frames[index][1]
    early = np.flatnonzero(times <= times[chosen[-1]] + TIME_TOLERANCE)
    return Tracks(scene.container(), times[chosen], positions, frames[0][1], times[early],
                  [frames[index][1][:, 2] for index in early])


def choose_snapshots(times, start=None, end=None):
    """Indices of the snapshots of the interval, LAG_TAU apart; raises CalibrationError where there are too few."""
    first = STEADY_FROM if start is None else start
    last = times[-1] if end is None else end
    stretches = _stretches(times, first, last)
    wanted = MINIMUM_BLOCKS * BLOCK_TAU
    if start is not None and len(stretches) > 1:
        gap = stretches[0][-1]
        raise CalibrationError(f"no snapshot {LAG_TAU:g} tau after that at {times[gap]:g} tau; velocities need one "
                               "every so often: choose --from and --to without a gap")
    longest = max(stretches, key=len, default=[])
    length = times[longest[-1]] - times[longest[0]] if len(longest) else 0
    if length < wanted - TIME_TOLERANCE:
        raise CalibrationError(f"too few snapshots: those {LAG_TAU:g} tau apart between {first:g} and {last:g} tau "
                               f"span {length:g} tau, but {wanted:g} are needed for errors ({MINIMUM_BLOCKS} blocks of "
                               f"{BLOCK_TAU:g} tau; the dumps hold {len(times)} snapshots, {times[0]:g} to "
                               f"{times[-1]:g} tau)")
    return np.array(longest)


def _stretches(times, first, last):
    """Lists of snapshots, each LAG_TAU after the one before; snapshots in between are passed over."""
    inside = np.flatnonzero((times >= first - TIME_TOLERANCE) & (times <= last + TIME_TOLERANCE))
    stretches = []
    for index in inside:
        passed = times[index] - times[stretches[-1][-1]] if stretches else np.inf
        if abs(passed - LAG_TAU) <= TIME_TOLERANCE:
            stretches[-1].append(index)
        elif passed > LAG_TAU:
            stretches.append([index])
    return stretches


def find_core(tracks):
    """The core of this flow, below the surface at the end; raises CalibrationError where the packing is too low."""
    surface = surface_height(tracks.frame(-1), tracks.container)
    half_width = min(CORE_HALF_WIDTH, 0.4 * tracks.container.half_width)
    core = Core(half_width, tracks.container.half_depth - WALL_LAYER, CORE_BOTTOM, min(CORE_TOP, surface - SURFACE_MARGIN))
    if core.top - CORE_HEIGHT < core.bottom - 1e-9:
        raise CalibrationError(f"the packing is too low: its surface is at z = {surface:.0f} d at "
                               f"{tracks.times[-1]:g} tau, and correlations need "
                               f"{CORE_BOTTOM + CORE_HEIGHT + SURFACE_MARGIN:g} d")
    return core


def surface_height(positions, container, width=2.5):
    """Height of the lowest part of the surface: the least of the tops of columns ``width`` wide in x, d."""
    columns = np.floor((positions[:, 0] + container.half_width) / width).astype(int)
    number = max(int(2 * container.half_width / width), 1)
    tops = np.zeros(number)
    np.maximum.at(tops, columns.clip(0, number - 1), positions[:, 2])
    return float(tops.min())
