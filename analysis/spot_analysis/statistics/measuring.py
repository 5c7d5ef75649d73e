# SPDX-License-Identifier: GPL-2.0-or-later
"""Measures the dumps of one run, snapshot by snapshot."""

import numpy as np

from ..base.errors import DumpError
from ..base.progress import Progress, share_of
from ..reading.dump import find_dumps, read_frames
from .passages import ROUNDS
from .recorder import Recorder
from .run_statistics import CONCEPTS
from .scene_fit import once_through, require_one_round_orifice, warn_of_misfit
from .snapshot import TIME_TOLERANCE


def measure_dumps(source, scene, label="dumps", provenance=None, warn=print, concepts=CONCEPTS, times=None):
    """Measure the dumps ``source`` (see ``dump.find_dumps``).

    label : for the progress lines
    warn : called with a line for frames that are left out, and for a scene that does not seem to be that of the dumps
    concepts : those of CONCEPTS to measure
    times : (n,) tau, of the snapshots to measure; None: all

    Snapshots before the opening of the orifice are left out. Raises DumpError, SceneError.
    """
    require_one_round_orifice(scene)
    files, early = len(find_dumps(source)), 0
    progress = Progress(label)
    recorder, frames = Recorder(scene, concepts), read_frames(source, extra=("radius", ROUNDS), warn=warn)
    for number, frame in enumerate(once_through(source, frames, scene), 1):
        if scene.time(frame.timestep) < -TIME_TOLERANCE:
            early += 1
            continue
        if times is not None and np.abs(times - scene.time(frame.timestep)).min() > TIME_TOLERANCE:
            continue
        recorder.add(frame)
        total = f" of {files}" if files > 1 else ""
        progress(f"{number} snapshots{total}, t = {recorder.times[-1]:g} tau", share_of(number, files))
    if not recorder.times:
        cause = (f"all {early} snapshots are from before the orifice opens, at {scene.opening_time:g} (opening_time)"
                 if early == number else "no snapshot is at one of the times that are asked for")
        raise DumpError(f"{source}: {cause}")
    if early:
        warn(f"{source}: {early} snapshots from before the orifice opens, at {scene.opening_time:g} (opening_time), are left out")
    if abs(recorder.times[0]) > TIME_TOLERANCE:
        warn(f"{source}: the first snapshot is at t = {recorder.times[0]:g} tau; the density drop and the colours of "
             "the layers are relative to it, not to the start")
    progress.finish(f"{len(recorder.times)} snapshots measured, t = {recorder.times[0]:g} to {recorder.times[-1]:g} tau")
    statistics = recorder.statistics(provenance or {})
    warn_of_misfit(source, statistics, recorder.lowest, warn)
    return statistics
