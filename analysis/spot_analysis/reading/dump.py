# SPDX-License-Identifier: GPL-2.0-or-later
"""Reader for the text dumps of LAMMPS and LIGGGHTS (``dump custom``, ``dump atom``).

Plain, gzip or zstd (told by content), one frame or many in a file, any number and order of columns, any number of
atoms in each frame. The coordinate along x is taken from the first column among

    x, xu, xs, xsu

and where the box is periodic along x, from xu, xsu, or x or xs with the image flags ix, since a wrapped coordinate alone
does not tell where a grain went; likewise y and z. xs and xsu are scaled with the frame's own box, which may be written
as a triclinic one without tilt. Values are in the dump's own units.
"""

import contextlib
import glob
import gzip
import io
import itertools
import os
import re
import warnings
import zlib
from dataclasses import dataclass, field

import numpy as np
import zstandard

from ..base.errors import DumpError, TruncatedFrame

AXES = "xyz"
TILTS = ["xy", "xz", "yz"]
CUT = "the run was stopped or the disk was full while it was written; write it again, or take the cut frame out of it"
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
            raise TruncatedFrame(f"{self.path}: the compressed file ends after line {self.number}: {CUT}") from error
        except DAMAGED as error:
            raise DumpError(f"{self.path}: damaged compressed data after line {self.number} ({error})") from error
        self.number += len(lines)
        return lines

    def need(self, count, what):
        """The next ``count`` lines; a last line without its end counts as cut off."""
        lines = self.take(count)
        if len(lines) < count or not lines[-1].endswith("\n"):
            raise self.cut(f"{what} ({len(lines)} of {count} lines)")
        return lines

    def cut(self, what):
        return TruncatedFrame(f"{self.path}, line {self.number}: the file ends inside {what}: {CUT}")

    def error(self, message, line=None):
        return DumpError(f"{self.path}, line {line or self.number}: {message}")


class _ZstdReader(io.RawIOBase):
    """Decompressed bytes of a zstd file of one or more zstd frames; EOFError where the last is cut.

    zstandard's own reader says nothing of a cut file, and stops after the first zstd frame.
    """

    CHUNK = 1 << 17  # compressed bytes

    def __init__(self, path):
        self._file = open(path, "rb")
        self._decoder = None
        self._bytes = memoryview(b"")

    def readable(self):
        return True

    def readinto(self, buffer):
        while not self._bytes:
            data = self._file.read(self.CHUNK)
            if not data:
                if self._decoder is not None:
                    raise EOFError("the zstd frame is cut")
                return 0
            self._bytes = memoryview(b"".join(self._decompress(data)))
        count = min(len(buffer), len(self._bytes))
        buffer[:count] = self._bytes[:count]
        self._bytes = self._bytes[count:]
        return count

    def _decompress(self, data):
        while data:
            self._decoder = self._decoder or zstandard.ZstdDecompressor().decompressobj()
            yield self._decoder.decompress(data)
            data = self._decoder.unused_data
            if self._decoder.eof:
                self._decoder = None

    def close(self):
        self._file.close()
        super().close()


def _open_zstd(path, mode, **options):
    return io.TextIOWrapper(io.BufferedReader(_ZstdReader(path)), **options)


OPENERS = {b"\x1f\x8b": gzip.open, b"\x28\xb5\x2f\xfd": _open_zstd}  # by the first bytes of a file


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
    if "id" not in columns:
        raise lines.error(f"column 'id' is missing (the columns are: {' '.join(columns) or 'none'})")
    coordinates = [_coordinate(axis, periodic, columns, lines) for axis, periodic in zip(AXES, header["PERIODIC"])]
    optional = [name for name in extra if name in columns]
    wanted = ["id", *(name for one in coordinates for name in one.names()), *optional]
    table = _read_table(lines, count, columns, wanted)
    table = table[np.argsort(table[:, 0], kind="stable")]
    named = dict(zip(wanted, table.T))
    ids = _whole(named["id"], "id", lines)
    _check_unique(ids, lines)
    positions = np.stack([one.values(named, bounds, lines) for one, bounds in zip(coordinates, header["BOX BOUNDS"])], axis=1)
    _check_finite(ids, positions, lines)
    return Frame(header["TIMESTEP"], ids, positions, header["BOX BOUNDS"], {name: named[name] for name in optional})


def _read_header(lines):
    """Items up to and including ATOMS as a dictionary; None at the end of the file."""
    header = {}
    while "ATOMS" not in header:
        taken = lines.take(1)
        if not taken and not header:
            return None
        if not taken or not taken[0].endswith("\n"):
            raise lines.cut("a frame's header")
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
    elif item.split()[:2] == ["BOX", "BOUNDS"]:
        header["BOX BOUNDS"], header["PERIODIC"] = _read_box(lines, item.split()[2:])
    elif item.split()[:1] == ["ATOMS"]:
        header["ATOMS"] = item.split()[1:]
    else:
        raise lines.error(f"unknown 'ITEM: {item}' (a dump of atoms has TIMESTEP, TIME, UNITS, NUMBER OF ATOMS, "
                          "BOX BOUNDS and ATOMS)")


def _read_box(lines, words):
    """Bounds (3, 2) and which axes are periodic; words : what follows "BOX BOUNDS" in the header."""
    tilted = words[:3] == TILTS
    flags = words[3:] if tilted else words
    if flags and (len(flags) != 3 or not all(re.fullmatch("[pfsm]{2}", flag) for flag in flags)):
        raise lines.error(f"'ITEM: BOX BOUNDS' wants the boundaries of three axes, such as 'ff ff ff', found "
                          f"'{' '.join(words)[:60]}' (general triclinic boxes are not supported)")
    rows = [row.split() for row in lines.need(3, "'ITEM: BOX BOUNDS'")]
    if any(len(row) != (3 if tilted else 2) for row in rows):
        raise lines.error("'ITEM: BOX BOUNDS' wants two numbers an axis" + (", and a tilt" if tilted else
                          " (a triclinic box has a third, and 'xy xz yz' in the header)"))
    try:
        numbers = np.array(rows, dtype=float)
    except ValueError as error:
        raise lines.error(f"'ITEM: BOX BOUNDS': {error}") from error
    if np.any(numbers[:, 2:] != 0):
        tilts = ", ".join(f"{name} = {tilt:g}" for name, tilt in zip(TILTS, numbers[:, 2]))
        raise lines.error(f"'ITEM: BOX BOUNDS': the box is tilted ({tilts}); triclinic boxes are read without tilt only")
    return numbers[:, :2], [flag[0] == "p" for flag in flags or ("ff",) * 3]


@dataclass(frozen=True)
class _Coordinate:
    """How one coordinate is read.

    column : its name; scaled : whether it counts from 0 to 1 across the box
    image : column of the image flags to be added, None where it is not wrapped
    """

    column: str
    scaled: bool
    image: str = None

    def names(self):
        return (self.column, self.image) if self.image else (self.column,)

    def values(self, named, bounds, lines):
        """(n,) from the columns by name and the box's bounds (2,) along the axis."""
        low, high = bounds
        values = low + named[self.column] * (high - low) if self.scaled else named[self.column]
        return values + _whole(named[self.image], self.image, lines) * (high - low) if self.image else values


def _coordinate(axis, periodic, columns, lines):
    """The _Coordinate of ``axis``; raises DumpError where no column tells it."""
    plain, scaled = axis, f"{axis}s"
    unwrapped, unwrapped_scaled, image = f"{axis}u", f"{axis}su", f"i{axis}"
    order = (unwrapped, unwrapped_scaled, plain, scaled) if periodic else (plain, unwrapped, scaled, unwrapped_scaled)
    column = next((name for name in order if name in columns), None)
    if column is None:
        raise lines.error(f"column '{axis}' is missing (the columns are: {' '.join(columns)}; positions are wanted as "
                          "x y z, xu yu zu, xs ys zs, xsu ysu zsu)")
    wrapped = periodic and column in (plain, scaled)
    if wrapped and image not in columns:
        raise lines.error(f"the box is periodic along {axis}, where column '{column}' alone does not tell how far grains "
                          f"went: column '{unwrapped}' or the image flags '{image}' are missing")
    return _Coordinate(column, column in (scaled, unwrapped_scaled), image if wrapped else None)


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


def _whole(values, column, lines):
    """The values (n,) as int64; raises DumpError where one is no whole number."""
    with np.errstate(invalid="ignore"):  # NaN is no whole number either
        whole = values.astype(np.int64)
    if not np.array_equal(whole, values):
        raise lines.error(f"column '{column}' holds values that are no whole numbers (frame ending here)")
    return whole


def _check_unique(ids, lines):
    repeated = np.flatnonzero(np.diff(ids) == 0)
    if repeated.size:
        raise lines.error(f"grain id {ids[repeated[0]]} stands twice in the frame ending here")


def _check_finite(ids, positions, lines):
    bad = np.flatnonzero(~np.isfinite(positions).all(axis=1))
    if bad.size:
        raise lines.error(f"position of grain {ids[bad[0]]} is not finite in the frame ending here "
                          f"({bad.size} such grains)")


def _nothing_in(path):
    """The error for a file without a single line."""
    if os.path.getsize(path) > 0:
        return DumpError(f"{path}: the compressed file holds nothing")
    return DumpError(f"{path}: the file is empty (as dumps are on a full disk)")


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
