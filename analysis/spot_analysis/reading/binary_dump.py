# SPDX-License-Identifier: GPL-2.0-or-later
"""Reader for the binary dumps of LAMMPS (``dump custom`` or ``dump atom`` into FILE.bin), as it has written them since
2021: told by their first bytes, they name their columns.

A frame is, without padding and in the byte order of the machine that wrote it: a negative length and the word DUMPCUSTOM
or DUMPATOM; three numbers of format, timestep, atoms, box, columns; then blocks of doubles, one of each rank.
"""

import os
import re
import struct

import numpy as np

from ..base.errors import DumpError, TruncatedFrame
from .frame import frame_of
from .lines import CUT

MAGIC = re.compile(rb"(.{8})(DUMPCUSTOM|DUMPATOM)", re.DOTALL)
LONGEST = 1 << 20  # of a text in the header
BOUNDARIES = 6  # flags of the boundary; 0 is periodic


def is_binary(path):
    """Raises DumpError where the file cannot be opened."""
    try:
        with open(path, "rb") as handle:
            return MAGIC.match(handle.read(18)) is not None
    except OSError as error:
        raise DumpError(f"{path}: {error.strerror}") from error


def read_binary_frames(path, extra=()):
    """Yield every frame of one file; raises TruncatedFrame when the file ends inside one."""
    with open(path, "rb") as handle:
        source = _Bytes(path, handle)
        while source.goes_on():
            header, values = _read_frame(source)
            columns = header["ATOMS"]
            yield frame_of(header, lambda wanted: values[:, [columns.index(name) for name in wanted]], source, extra)


def first_timestep(path):
    """Of the first frame; infinite where the file ends before it."""
    with open(path, "rb") as handle:
        try:
            return _read_start(_Bytes(path, handle))
        except TruncatedFrame:
            return float("inf")


class _Bytes:
    """Numbers of one file; the place in it is for error messages."""

    order = "<"

    def __init__(self, path, handle):
        self._path, self._handle = path, handle
        self._size = os.path.getsize(path)

    def goes_on(self):
        return self._handle.tell() < self._size

    def bytes(self, count, what):
        if count > self._size - self._handle.tell():
            raise TruncatedFrame(f"{self._path}, byte {self._size}: the file ends inside {what}: {CUT}")
        return self._handle.read(count)

    def numbers(self, kind, what):
        """Of a format of ``struct``; a tuple."""
        kind = self.order + kind
        return struct.unpack(kind, self.bytes(struct.calcsize(kind), what))

    def text(self, what):
        """A length, and as many letters."""
        (length,) = self.numbers("i", what)
        if not 0 <= length < LONGEST:
            raise self.error(f"{what} is {length} letters long")
        return self.bytes(length, what).decode("ascii", "replace")

    def doubles(self, count, what):
        return np.frombuffer(self.bytes(8 * count, what), self.order + "f8")

    def error(self, message):
        return DumpError(f"{self._path}, byte {self._handle.tell()}: {message}")


def _read_start(source):
    """The timestep; what comes next is the number of atoms."""
    start = source.bytes(8, "a frame's header")
    word = source.bytes(8, "a frame's header")
    if word == b"DUMPCUST":
        word += source.bytes(2, "a frame's header")
    if word not in (b"DUMPCUSTOM", b"DUMPATOM"):
        raise source.error(f"expected DUMPCUSTOM or DUMPATOM, found {word!r}")
    source.order = next((order for order in "<>" if struct.unpack(order + "q", start)[0] == -len(word)), None)
    if source.order is None:
        raise source.error(f"{word.decode()} has another length than is said")
    endian, revision = source.numbers("ii", "a frame's header")
    if endian != 1 or revision != 2:
        raise source.error(f"format {revision}, byte order {endian}, but this reads format 2 in order 1")
    return source.numbers("q", "a frame's header")[0]


def _read_frame(source):
    """(header, values): as of ``header.read_header``, and (atoms, columns) float64."""
    step = _read_start(source)
    count, triclinic = source.numbers("qi", "a frame's header")
    boundary = source.numbers(f"{BOUNDARIES}i", "a frame's header")
    box = np.reshape(source.numbers("6d", "the box"), (3, 2))
    if triclinic:
        if triclinic != 1 or any(source.numbers("3d", "the box")):
            raise source.error("the box is tilted; triclinic boxes are read without tilt only")
    (width,) = source.numbers("i", "a frame's header")
    source.text("the units")
    if source.numbers("B", "the time")[0]:
        source.numbers("d", "the time")
    columns = source.text("the names of columns").split()
    (blocks,) = source.numbers("i", "a frame's header")
    if step < 0 or count < 0 or width != len(columns) or blocks < 0:
        raise source.error(f"timestep {step}, {count} atoms, {width} columns called {' '.join(columns)[:60]}, {blocks} blocks: "
                           "no such frame")
    header = {"TIMESTEP": step, "NUMBER OF ATOMS": count, "BOX BOUNDS": box, "ATOMS": columns,
              "PERIODIC": [flag == 0 for flag in boundary[::2]]}
    return header, _read_blocks(source, blocks, count, width)


def _read_blocks(source, blocks, count, width):
    found, left = [], count * width
    for _ in range(blocks):
        (size,) = source.numbers("i", "a block of atoms")
        if not 0 <= size <= left:
            raise source.error(f"a block of {size} numbers, where {left} are left of {count} atoms with {width} columns")
        found.append(source.doubles(size, "a block of atoms"))
        left -= size
    if left:
        raise source.error(f"{count} atoms with {width} columns are announced, but {left} numbers are missing")
    return np.concatenate(found or [np.empty(0)]).astype(float).reshape(count, width)
