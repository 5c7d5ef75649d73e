# SPDX-License-Identifier: GPL-2.0-or-later
"""Reader for the dumps of LAMMPS and LIGGGHTS (``dump custom``, ``dump atom``).

Text, plain, gzip or zstd, or LAMMPS' binary, told by content. One frame or many in a file, any number and order of
columns, any number of atoms in each frame. The coordinate along x is taken from the first column among

    x, xu, xs, xsu

and where the box is periodic along x, from xu, xsu, or x or xs with the image flags ix, since a wrapped coordinate alone
does not tell where a grain went; likewise y and z. xs and xsu are scaled with the frame's own box, which may be written
as a triclinic one without tilt. Values are in the dump's own units.
"""

import glob
import itertools
import os
import warnings

from ..base.errors import DumpError, TruncatedFrame
from . import binary_dump
from .compression import DAMAGED, open_text
from .frame import read_frame
from .header import read_item
from .lines import Lines


def find_dumps(source):
    """Files of ``source`` in the order of their first timestep.

    source : a file, a wildcard, or a folder (then every file with "dump" or "lammpstrj" in its name except the
        tables of ``dump local``)

    Raises DumpError where there is none, or one of them is empty or no dump.
    """
    if os.path.isdir(source):
        paths = [entry.path for entry in os.scandir(source) if entry.is_file()
                 and any(word in entry.name for word in ("dump", "lammpstrj"))]
        paths = [path for path in paths if not _is_local_dump(path)]
        wanted = "files with 'dump' or 'lammpstrj' in their names"
    else:
        paths = [path for path in glob.glob(source) if os.path.isfile(path)] or \
                ([source] if os.path.isfile(source) else [])
        wanted = "such file"
    if not paths:
        raise DumpError(f"{source}: no {wanted}")
    return sorted(paths, key=lambda path: (_first_timestep(path), path))


def read_frames(source, extra=(), warn=warnings.warn):
    """Yield the frames of ``source`` (see ``find_dumps``) in the order of their timesteps.

    extra : names or wildcards of further columns to return where the file has them
    warn : called with one line of text when a frame is left out because its timestep was read already (runs
        continued from a restart write one twice)

    Raises TruncatedFrame when a file ends inside a frame, DumpError for everything else that cannot be read; both
    name file, line and cause.
    """
    last_step = None
    for path in find_dumps(source):
        for frame in read_file(path, extra):
            if last_step is not None and frame.timestep <= last_step:
                warn(f"{path}: timestep {frame.timestep} was read already and is left out")
                continue
            last_step = frame.timestep
            yield frame


def read_file(path, extra=()):
    """Yield every frame of one file; raises TruncatedFrame when the file ends inside one."""
    if binary_dump.is_binary(path):
        yield from binary_dump.read_binary_frames(path, extra)
        return
    with open_text(path) as handle:
        lines = Lines(path, handle)
        frames = 0
        while (frame := read_frame(lines, extra)) is not None:
            frames += 1
            yield frame
        if frames == 0:
            raise _nothing_in(path)


def _nothing_in(path):
    """The error for a file without a single line."""
    if os.path.getsize(path) > 0:
        return DumpError(f"{path}: the compressed file holds nothing")
    return DumpError(f"{path}: the file is empty (as dumps are on a full disk)")


def _first_timestep(path):
    """Timestep of a file's first frame; infinite where the file ends before it."""
    if binary_dump.is_binary(path):
        return binary_dump.first_timestep(path)
    with open_text(path) as handle:
        lines = Lines(path, handle)
        header = {}
        try:
            while "TIMESTEP" not in header:
                taken = lines.take(1)
                if not taken and lines.number == 0:
                    raise _nothing_in(path)
                if not taken or not taken[0].endswith("\n") and "ITEM: ".startswith(taken[0][:6]):
                    return float("inf")
                if not taken[0].startswith("ITEM: "):
                    raise lines.error(f"no dump: expected a line 'ITEM: ...', found '{taken[0].strip()[:60]}'")
                read_item(lines, taken[0][len("ITEM: "):].strip(), header)
        except TruncatedFrame:
            return float("inf")
    return header["TIMESTEP"]


def _is_local_dump(path):
    if binary_dump.is_binary(path):
        return False
    with open_text(path) as handle:
        try:
            return any(line.startswith("ITEM: NUMBER OF ENTRIES") for line in itertools.islice(handle, 8))
        except (EOFError, *DAMAGED):
            return False
