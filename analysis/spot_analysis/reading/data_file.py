# SPDX-License-Identifier: GPL-2.0-or-later
"""Reader for data files of LAMMPS (``atom_style sphere``) and LIGGGHTS (``granular``), plain or compressed."""

import re

import numpy as np

from ..base.errors import DumpError
from .compression import DAMAGED, open_text
from .grain_table import Grains, check_diameters, table_of

COLUMNS = ["id", "type", "diameter", "density", "x", "y", "z"]
IMAGES = ["ix", "iy", "iz"]
STYLES = ("sphere", "granular")


def read_data_file(path):
    """The Grains of a data file; raises DumpError that names the line."""
    with open_text(path) as handle:
        try:
            lines = [line.split("#")[0].split() for line in handle]
            handle.seek(0)
            titles = {number: line for number, line in enumerate(handle, 1) if re.match(r"\s*Atoms\b", line)}
        except (EOFError, *DAMAGED) as error:
            raise DumpError(f"{path}: damaged or cut compressed data ({error})") from error
    count = next(int(words[0]) for words in lines if len(words) == 2 and words[1] == "atoms" and words[0].isdigit())
    if not titles:
        raise DumpError(f"{path}: no section 'Atoms'")
    start, title = next(iter(titles.items()))
    style = title.partition("#")[2].split()
    if style and style[0] not in STYLES:
        raise DumpError(f"{path}, line {start}: atoms of style '{style[0]}', where 'sphere' is wanted (columns: {' '.join(COLUMNS)})")
    rows = []
    for number, words in enumerate(lines[start:], start + 1):
        if len(rows) == count or words and words[0][0].isalpha():
            break
        if words:
            rows.append((number, words))
    if len(rows) < count:
        raise DumpError(f"{path}, line {start + len(rows)}: {len(rows)} of {count} atoms; the file is cut")
    names = COLUMNS + (IMAGES if rows and len(rows[0][1]) == len(COLUMNS + IMAGES) else [])
    table = table_of(path, rows, names, ["id", "diameter", "density", "x", "y", "z"])
    ids, first = np.unique(table[:, 0], return_index=True)
    if len(ids) < count:
        again = np.setdiff1d(np.arange(count), first)[0]
        raise DumpError(f"{path}, line {rows[again][0]}: grain id {table[again, 0]:.0f} stands twice")
    table = table[first]
    return Grains(table[:, 3:], check_diameters(path, table[:, 1]), float(table[:, 2].mean()), "a data file")
