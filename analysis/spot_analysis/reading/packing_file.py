# SPDX-License-Identifier: GPL-2.0-or-later
"""A packing from any file that DEM programs write it to: dumps, data files of LAMMPS and LIGGGHTS, columns of numbers."""

import itertools
import os
import re

import numpy as np

from ..base.errors import DumpError
from .binary_dump import is_binary
from .columns_file import read_columns
from .compression import DAMAGED, open_text
from .data_file import read_data_file
from .dump import find_dumps, read_file
from .grain_table import Grains, check_diameters


def read_packing(source, step=None, columns=None):
    """The Grains of ``source``.

    source : a file, or a folder or wildcard of dumps
    step : timestep of a dump's frame (default: the last)
    columns : names of the columns of a file that has no header, x y z and r or d among them

    Raises DumpError that names file, line and column.
    """
    kind = "dump" if os.path.isdir(source) or not os.path.isfile(source) else _kind(source)
    if step is not None and kind != "dump":
        raise DumpError(f"{source}: --step is for dumps, and this is none")
    if columns and kind != "columns":
        raise DumpError(f"{source}: --columns is for plain columns of numbers, and this is a {kind}")
    if kind == "dump":
        return _from_dump(source, step)
    return read_data_file(source) if kind == "data file" else read_columns(source, columns)


def _kind(path):
    """What the first lines look like."""
    if is_binary(path):
        return "dump"
    with open_text(path) as handle:
        try:
            start = list(itertools.islice(handle, 40))
        except (EOFError, UnicodeError, *DAMAGED) as error:
            raise DumpError(f"{path}: damaged compressed data ({error})") from error
    if not start:
        raise DumpError(f"{path}: the file is empty")
    if start[0].startswith("ITEM:"):
        return "dump"
    return "data file" if any(re.match(r"\s*\d+\s+atoms\b", line) for line in start) else "columns"


def _from_dump(source, step):
    frame = None
    for path in find_dumps(source) if step is not None else find_dumps(source)[-1:]:
        for frame in read_file(path, ("radius", "diameter", "density")):
            if frame.timestep == step:
                break
        else:
            continue
        break
    if step is not None and (frame is None or frame.timestep != step):
        raise DumpError(f"{source}: no frame of timestep {step}")
    if not len(frame.ids):
        raise DumpError(f"{source}: there is no grain in timestep {frame.timestep}")
    diameters = frame.extra.get("diameter")
    if diameters is None and "radius" in frame.extra:
        diameters = 2 * frame.extra["radius"]
    density = float(np.mean(frame.extra["density"])) if "density" in frame.extra else None
    return Grains(frame.positions, check_diameters(source, diameters), density, f"timestep {frame.timestep} of a dump")
