# SPDX-License-Identifier: GPL-2.0-or-later
"""Reader for the spots that fix spot hands to LAMMPS' ``dump local``: ID, x, y, z and two columns more a row."""

import os

import numpy as np

from ..base.errors import DumpError
from .compression import open_text
from .header import read_item
from .lines import Lines

COLUMNS = 6


def read_spots(folder):
    """Timestep -> positions (m, 3) of its live spots in the dump's units, of every ``dump local`` in ``folder``.

    Raises DumpError where a file is cut or holds something else.
    """
    found = {}
    for entry in sorted(os.scandir(folder), key=lambda entry: entry.name) if os.path.isdir(folder) else ():
        if entry.is_file() and "dump" in entry.name:
            with open_text(entry.path) as handle:
                lines = Lines(entry.path, handle)
                while (frame := _read_entries(lines)) is not None:
                    found[frame[0]] = frame[1]
    return found


def _read_entries(lines):
    """(timestep, positions) of the next frame; None at the end of the file, and where it is a dump of atoms."""
    header, count = {}, None
    while taken := lines.take(1):
        words = taken[0].split()
        if words[:1] != ["ITEM:"] or words[1:2] == ["ATOMS"] or words[1:4] == ["NUMBER", "OF", "ATOMS"]:
            return None
        if words[1:] == ["NUMBER", "OF", "ENTRIES"]:
            text = lines.need(1, "'ITEM: NUMBER OF ENTRIES'")[0].strip()
            if not text.isdigit():
                raise lines.error(f"'ITEM: NUMBER OF ENTRIES' wants a whole number, found '{text}'")
            count = int(text)
        elif words[1:2] == ["ENTRIES"]:
            if count is None or "TIMESTEP" not in header:
                raise lines.error("'ITEM: ENTRIES' without a timestep and a number of entries before it")
            return header["TIMESTEP"], _positions(lines, count, words[2:])
        else:
            read_item(lines, " ".join(words[1:]), header)
    return None


def _positions(lines, count, columns):
    if len(columns) != COLUMNS:
        raise DumpError(f"{lines.path}, line {lines.number}: spots have {COLUMNS} columns, as "
                        f"'dump ID all local N FILE f_ID[1] ... f_ID[6]' writes them; found {' '.join(columns)}")
    if count == 0:
        return np.empty((0, 3))
    rows = lines.need(count, "'ITEM: ENTRIES'")
    try:
        return np.loadtxt(rows, ndmin=2)[:, 1:4]
    except (IndexError, ValueError) as error:
        raise lines.error(f"the rows of this frame are not a table of numbers ({error})") from error
