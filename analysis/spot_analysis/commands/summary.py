# SPDX-License-Identifier: GPL-2.0-or-later
"""Measure what a scene has, or compare it, whatever the scene: hopper.py, box.py or mixture.py, as scene.json and the
sizes of the grains tell; round_heap.py or turnovers.py where its statistics are among the runs."""

import numpy as np

from ..base.errors import SceneError
from ..reading.dump import read_frames
from ..reading.scene import BOX_KEYS, HOPPER_KEYS, path_beside, read_values, require_existence
from . import box, command_line, hopper, mixture, quantities, round_heap, turnovers

KINDS = (hopper.KIND, box.KIND, mixture.KIND, round_heap.KIND, turnovers.KIND)
ROUND = (hopper.KIND, round_heap.KIND, turnovers.KIND)  # of one scene.json
UNEQUAL = 1e-3  # relative difference of radii


def kind_of(run):
    """The Kind of scene of dumps, or of a file of --output; raises SceneError for a scene that none measures."""
    if quantities.is_stored(run):
        return _kind_of_names(quantities.read_stored(run)["quantities"])
    require_existence(run)
    path = path_beside(run)
    values = read_values(path)
    if any(key in values for key in HOPPER_KEYS):
        return hopper.KIND
    if not any(key in values for key in BOX_KEYS):
        raise SceneError(f"{path}: the scene tells no walls, neither of a box ({', '.join(BOX_KEYS)}) nor of a hopper "
                         f"({', '.join(HOPPER_KEYS)}); analysis/render.py draws it")
    return mixture.KIND if _is_unequal(run) else box.KIND


def _is_unequal(run):
    radius = next(read_frames(run, extra=("radius",), warn=command_line.print_warning)).extra.get("radius", np.empty(0))
    return len(radius) > 0 and np.ptp(radius) > UNEQUAL * radius.max()


def _kind_of_names(names):
    if "large_share_left" in names:
        return mixture.KIND
    if "over_after" in names:
        return round_heap.KIND
    if "never_drained" in names:
        return turnovers.KIND
    return hopper.KIND if any(name.startswith("mass_flow_index") for name in names) else box.KIND


def common_kind(runs):
    """The Kind by which all can be measured; raises SceneError where there is none. A mixture may have grains of one
    size, and a hopper may be drained to its end: so stored statistics decide, or else any run with two sizes."""
    kinds = [kind_of(run) for run in runs]
    other = next((k for k, kind in enumerate(kinds) if (kind in ROUND) != (kinds[0] in ROUND)), None)
    if other is not None:
        raise SceneError(f"{runs[0]} is a {kinds[0].what}, but {runs[other]} is a {kinds[other].what}")
    stored = [kind for run, kind in zip(runs, kinds) if quantities.is_stored(run)]
    return stored[0] if stored else mixture.KIND if mixture.KIND in kinds else kinds[0]


def summarize():
    starts, ends = ("by the scene: " + ", ".join(f"{bound(kind):g} of a {kind.what}" for kind in KINDS)
                    for bound in (lambda kind: kind.start, lambda kind: kind.end))
    options = quantities.parse_arguments(__doc__, "Lengths are in d, times in tau.",
                                         "what the script for the scene draws", starts, ends)
    quantities.compare(options, common_kind(options.runs))


def main():
    command_line.run(summarize)
