# SPDX-License-Identifier: GPL-2.0-or-later
"""What the scripts share: scene options, opening a run, errors as one line."""

import os
import sys

from ..base.errors import AnalysisError
from ..reading.dump import read_frames
from ..reading.scene import NUMBERS, ORIGIN, load_scene
from ..report import left_out
from ..statistics import run_statistics
from ..statistics.measuring import measure_dumps
from ..statistics.passages import ROUNDS
from ..statistics.scene_fit import require_diameter


def add_scene_options(parser, prefix=""):
    """Options for the scene of dumps: a file, or single values that win over it."""
    group = parser.add_argument_group(f"scene of the {prefix or 'dumps'} (in the dumps' units)".replace("-", ""))
    group.add_argument(f"--{prefix}scene", metavar="FILE",
                       help="JSON file to read instead of scene.json beside the dumps")
    for key in NUMBERS + ORIGIN:
        group.add_argument(f"--{prefix}{key.replace('_', '-')}", type=float, metavar="X")


def scene_from_options(options, source, prefix=""):
    """The Scene of the dumps ``source``; raises SceneError."""
    values = vars(options)
    key = prefix.replace("-", "_")
    overrides = {name: values[key + name] for name in NUMBERS + ORIGIN}
    return load_scene(source, values[key + "scene"], overrides)


def open_run(source, options, prefix, label, concepts=run_statistics.CONCEPTS):
    """Statistics of ``source``: loaded if it is a statistics file, measured if it is dumps; then of ``concepts`` only."""
    if os.path.isfile(source) and source.endswith(".npz"):
        return run_statistics.load(source)
    scene = scene_from_options(options, source, prefix)
    return measure_dumps(source, scene, label, warn=print_warning, concepts=concepts)


def frames_of_equal_grains(source, scene):
    """The frames of dumps, with what counts rounds; raises SceneError where grains cannot have the scene's diameter."""
    for frame in read_frames(source, extra=("radius", ROUNDS), warn=print_warning):
        require_diameter(scene, frame)
        yield frame


def print_warning(text):
    print(f"warning: {text}", file=sys.stderr)


def warn_of_left_out(reasons):
    """One warning for all quantities, name -> why, that are unknown."""
    text = left_out.summary(reasons)
    if text:
        print_warning(text)


def run(main):
    """Call main(); turn bad input into one line and exit status 1."""
    try:
        main()
    except AnalysisError as error:
        sys.exit(f"error: {error}")
    except BrokenPipeError:
        sys.exit(1)
    except OSError as error:  # without a name where a write failed, as on a full disk
        sys.exit(f"error: {error.filename or 'output'}: {error.strerror}")
