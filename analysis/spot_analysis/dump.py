# SPDX-License-Identifier: GPL-2.0-or-later
"""Reader for the text dumps of LAMMPS and LIGGGHTS (``dump custom``, ``dump atom``).

Plain, gzip or zstd (told by content), one frame or many in a file, any number and order of columns, any number of
atoms in each frame. Positions are taken from the first complete set of columns among

    x y z, xu yu zu, xs ys zs, xsu ysu zsu

(the walls of a silo are not periodic, so wrapped and unwrapped positions are the same); the last two are
scaled with the frame's own box. Values are in the dump's own units.
"""

import contextlib
import glob
import gzip
import itertools
import os
import warnings
import zlib
from dataclasses import dataclass, field

import numpy as np
import zstandard

from .errors import DumpError, TruncatedFrame

POSITION_COLUMNS = (("x", "y", "z"), ("xu", "yu", "zu"), ("xs", "ys", "zs"), ("xsu", "ysu", "zsu"))
SCALED = POSITION_COLUMNS[2:]

OPENERS = {b"\x1f\x8b": gzip.open, b"\x28\xb5\x2f\xfd": zstandard.open}  # by the first bytes of a file
DAMAGED = (zlib.error, gzip.BadGzipFile, zstandard.ZstdError)


@dataclass(frozen=True)
class Frame:
    """One snapshot, sorted by id.

    timestep : int
    ids : (n,) int64, ascending
    positions : (n, 3) float64
    box : (3, 2) float64, lower and upper bound of each axis
    extra : name -> (n,) float64, the optional columns that were asked for and are in the file
    """

    timestep: int
    ids: np.ndarray
    positions: np.ndarray
    box: np.ndarray
    extra: dict = field(default_factory=dict)


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

    extra : names of further columns to return where the file has them
    warn : called with one line of text when something is left out: a truncated last frame, or a frame whose
        timestep was read already (runs continued from a restart write one twice)

    Raises TruncatedFrame when a file other than the last ends inside a frame or no frame is complete, DumpError
    for everything else that cannot be read; both name file, line and cause.
    """
    paths = find_dumps(source)
    last_step = None
    for path in paths:
        try:
            for frame in read_file(path, extra):
                if last_step is not None and frame.timestep <= last_step:
                    warn(f"{path}: timestep {frame.timestep} was read already and is left out")
                    continue
                last_step = frame.timestep
                yield frame
        except TruncatedFrame as error:
            if path != paths[-1] or last_step is None:
                raise
            warn(f"{error}; that frame is left out")


def read_file(path, extra=()):
    """Yield every frame of one file; raises TruncatedFrame when the file ends inside one."""
    with _open_text(path) as handle:
        lines = _Lines(path, handle)
        frames = 0
        while (frame := _read_frame(lines, extra)) is not None:
            frames += 1
            yield frame
        if frames == 0:
            raise _nothing_in(path)


class _Lines:
    """The lines of one file with their number, for error messages."""

    def __init__(self, path, handle):
        self.path = path
        self.number = 0
        self._handle = handle

    def take(self, count):
        """The next ``count`` lines, fewer at the end of the file."""
        try:
            lines = list(itertools.islice(self._handle, count))
        except EOFError as error:
            raise TruncatedFrame(f"{self.path}: the compressed file ends after line {self.number}") from error
        except DAMAGED as error:
            raise DumpError(f"{self.path}: damaged compressed data after line {self.number} ({error})") from error
        self.number += len(lines)
        return lines

    def need(self, count, what):
        """The next ``count`` lines; a last line without its end counts as cut off."""
        lines = self.take(count)
        if len(lines) < count or not lines[-1].endswith("\n"):
            raise TruncatedFrame(f"{self.path}, line {self.number}: the file ends inside {what} "
                                 f"({len(lines)} of {count} lines)")
        return lines

    def error(self, message, line=None):
        return DumpError(f"{self.path}, line {line or self.number}: {message}")


@contextlib.contextmanager
def _open_text(path):
    try:
        with open(path, "rb") as probe:
            start = probe.read(4)
        opener = next((OPENERS[magic] for magic in OPENERS if start.startswith(magic)), open)
        with opener(path, "rt", encoding="ascii", errors="replace") as handle:
            yield handle
    except OSError as error:
        raise DumpError(f"{path}: {error.strerror or error}") from error


def _read_frame(lines, extra):
    """The next frame, or None at the end of the file."""
    header = _read_header(lines)
    if header is None:
        return None
    count, columns = header["NUMBER OF ATOMS"], header["ATOMS"]
    names, scaled = _position_columns(columns, lines)
    optional = [name for name in extra if name in columns]
    table = _read_table(lines, count, columns, ["id", *names, *optional])
    order = np.argsort(table[:, 0], kind="stable")
    table = table[order]
    ids = _checked_ids(table[:, 0], lines)
    positions = table[:, 1:4]
    if scaled:
        low, high = header["BOX BOUNDS"].T
        positions = low + positions * (high - low)
    _check_finite(ids, positions, lines)
    return Frame(header["TIMESTEP"], ids, np.ascontiguousarray(positions), header["BOX BOUNDS"],
                 dict(zip(optional, table[:, 4:].T)))


def _read_header(lines):
    """Items up to and including ATOMS as a dictionary; None at the end of the file."""
    header = {}
    while "ATOMS" not in header:
        taken = lines.take(1)
        if not taken and not header:
            return None
        if not taken or not taken[0].endswith("\n"):
            raise TruncatedFrame(f"{lines.path}, line {lines.number}: the file ends inside a frame's header")
        line = taken[0].strip()
        if not line.startswith("ITEM: "):
            raise lines.error(f"expected a line 'ITEM: ...', found '{line[:60]}'")
        _read_item(lines, line[len("ITEM: "):], header)
    for item in ("TIMESTEP", "NUMBER OF ATOMS", "BOX BOUNDS"):
        if item not in header:
            raise lines.error(f"'ITEM: ATOMS' without an 'ITEM: {item}' before it")
    return header


def _read_item(lines, item, header):
    """Read one header item into ``header``."""
    if item in ("TIMESTEP", "NUMBER OF ATOMS"):
        text = lines.need(1, f"'ITEM: {item}'")[0].strip()
        if not text.isdigit():
            raise lines.error(f"'ITEM: {item}' wants a whole number, found '{text}'")
        header[item] = int(text)
    elif item in ("TIME", "UNITS"):
        lines.need(1, f"'ITEM: {item}'")
    elif item.startswith("BOX BOUNDS"):
        rows = [row.split() for row in lines.need(3, "'ITEM: BOX BOUNDS'")]
        if any(len(row) != 2 for row in rows):
            raise lines.error("'ITEM: BOX BOUNDS' wants two numbers an axis (triclinic boxes are not supported)")
        try:
            header["BOX BOUNDS"] = np.array(rows, dtype=float)
        except ValueError as error:
            raise lines.error(f"'ITEM: BOX BOUNDS': {error}") from error
    elif item.split()[:1] == ["ATOMS"]:
        header["ATOMS"] = item.split()[1:]
    else:
        raise lines.error(f"unknown 'ITEM: {item}' (a dump of atoms has TIMESTEP, TIME, UNITS, NUMBER OF ATOMS, "
                          "BOX BOUNDS and ATOMS)")


def _position_columns(columns, lines):
    """Names of the three position columns, and whether they are scaled with the box."""
    if "id" not in columns:
        raise lines.error(f"column 'id' is missing (the columns are: {' '.join(columns) or 'none'})")
    for names in POSITION_COLUMNS:
        if all(name in columns for name in names):
            return names, names in SCALED
    missing = next((name for names in POSITION_COLUMNS if any(n in columns for n in names)
                    for name in names if name not in columns), "x")
    raise lines.error(f"column '{missing}' is missing (the columns are: {' '.join(columns)}; positions are wanted as "
                      + ", ".join(" ".join(names) for names in POSITION_COLUMNS) + ")")


def _read_table(lines, count, columns, wanted):
    """The wanted columns of the next ``count`` rows, (count, len(wanted)) float64."""
    if count == 0:
        return np.empty((0, len(wanted)))
    first = lines.number + 1
    rows = lines.need(count, "'ITEM: ATOMS'")
    # loadtxt looks at the wanted columns only, so a row that lost or gained another one is looked for here
    if any(len(row.split()) != len(columns) for row in rows):
        raise _bad_row(lines, rows, first, columns, wanted)
    try:
        return np.loadtxt(rows, comments=None, usecols=[columns.index(name) for name in wanted], ndmin=2)
    except ValueError:
        raise _bad_row(lines, rows, first, columns, wanted) from None


def _bad_row(lines, rows, first, columns, wanted):
    """The error for the first row that is not a row of numbers."""
    for number, row in enumerate(rows, first):
        values = row.split()
        if len(values) != len(columns):
            return lines.error(f"expected {len(columns)} columns ({' '.join(columns)}), "
                               f"found '{row.strip()[:60]}'", number)
        for name in wanted:
            try:
                float(values[columns.index(name)])
            except ValueError:
                return lines.error(f"column '{name}' is no number: '{values[columns.index(name)]}'", number)
    return lines.error("the rows of this frame are not a table of numbers")


def _checked_ids(values, lines):
    with np.errstate(invalid="ignore"):  # NaN is no whole number either
        ids = values.astype(np.int64)
    if not np.array_equal(ids, values):
        raise lines.error("column 'id' holds values that are no whole numbers (frame ending here)")
    repeated = np.flatnonzero(np.diff(ids) == 0)
    if repeated.size:
        raise lines.error(f"grain id {ids[repeated[0]]} stands twice in the frame ending here")
    return ids


def _check_finite(ids, positions, lines):
    bad = np.flatnonzero(~np.isfinite(positions).all(axis=1))
    if bad.size:
        raise lines.error(f"position of grain {ids[bad[0]]} is not finite in the frame ending here "
                          f"({bad.size} such grains)")


def _nothing_in(path):
    """The error for a file without a single line."""
    if os.path.getsize(path) > 0:  # zstd says nothing when its data are cut off
        return TruncatedFrame(f"{path}: the compressed file ends before the first line")
    return DumpError(f"{path}: the file is empty")


def _first_timestep(path):
    """Timestep of a file's first frame; infinite where the file ends before it."""
    with _open_text(path) as handle:
        lines = _Lines(path, handle)
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
                _read_item(lines, taken[0][len("ITEM: "):].strip(), header)
        except TruncatedFrame:
            return float("inf")
    return header["TIMESTEP"]


def _is_local_dump(path):
    with _open_text(path) as handle:
        try:
            return any(line.startswith("ITEM: NUMBER OF ENTRIES") for line in itertools.islice(handle, 8))
        except (EOFError, *DAMAGED):
            return False
