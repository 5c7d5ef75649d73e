# SPDX-License-Identifier: GPL-2.0-or-later
"""Reader for plain columns of numbers, CSV and YADE's text export (``yade.export.text``, ``textExt``).

The names of columns come from the caller, from YADE's line ``# format x_y_z_r``, or from a first line of words; else three
columns are x y z, and four or more begin with x y z r. They are separated by commas, semicolons, or blanks.
"""

import re

from ..base.errors import DumpError
from .compression import DAMAGED, open_text
from .grain_table import Grains, check_diameters, table_of

SAME = {"radius": "r", "rad": "r", "diameter": "d", "diam": "d", "pos_x": "x", "pos_y": "y", "pos_z": "z", "rho": "density"}


def read_columns(path, columns=None):
    """The Grains of ``path``; raises DumpError that names line and column.

    columns : their names, in place of what the file says
    """
    names, rows = [_plain(name) for name in columns or ()], []
    for number, text in enumerate(_lines(path), 1):
        if text.lstrip().startswith("#"):
            names = names or _names_of_comment(text)
            continue
        words = _split(text)
        if not words:
            continue
        if not rows and not _is_number(words[0]):
            names = names or [_plain(word) for word in words]
        else:
            rows.append((number, words))
    if not rows:
        raise DumpError(f"{path}: there is no grain in it")
    width = len(rows[0][1])
    if not names:
        if width < 3:
            raise DumpError(f"{path}, line {rows[0][0]}: neither a dump nor a data file, nor columns x y z: '{' '.join(rows[0][1])[:60]}'")
        names = "x y z r".split()[:width] + [f"column {k}" for k in range(5, width + 1)]
    missing = [axis for axis in "xyz" if axis not in names]
    if missing:
        raise DumpError(f"{path}: column '{missing[0]}' is missing (the columns are: {' '.join(names)}; --columns names them)")
    names += [f"column {k}" for k in range(len(names) + 1, width + 1)]  # textExt's attributes
    size = next((name for name in ("d", "r") if name in names), None)
    table = table_of(path, rows, names, ["x", "y", "z"] + [size] * bool(size))
    diameters = check_diameters(path, table[:, 3] * (2 if size == "r" else 1) if size else None)
    return Grains(table[:, :3], diameters, None, f"columns {' '.join(names[:8])}")


def _lines(path):
    with open_text(path) as handle:
        try:
            yield from handle
        except (EOFError, *DAMAGED) as error:
            raise DumpError(f"{path}: damaged or cut compressed data ({error})") from error


def _split(text):
    text = text.split("#")[0].strip()
    for separator in ",;":
        if separator in text:
            return [word.strip() for word in text.split(separator)]
    return text.split()


def _plain(name):
    name = re.sub(r"\s*[\[(].*", "", name.strip().strip('"').lower())  # of its unit
    return SAME.get(name, name)


def _names_of_comment(text):
    """Columns by YADE's ``# format id_x_y_z_r_matId``, or by a comment of their names."""
    words = text.strip().lstrip("#").split()
    if words[:1] == ["format"] and len(words) > 1:
        return [_plain(word) for word in words[1].split("_") if word != "attrs"]
    names = [_plain(word) for word in _split(" ".join(words))]
    return names if {"x", "y", "z"} <= set(names) else []


def _is_number(word):
    try:
        float(word)
    except ValueError:
        return False
    return True
