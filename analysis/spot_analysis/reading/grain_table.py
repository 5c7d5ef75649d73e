# SPDX-License-Identifier: GPL-2.0-or-later
"""Grains by line in files that are no dumps: rows of numbers under names of columns."""

from dataclasses import dataclass

import numpy as np

from ..base.errors import DumpError


@dataclass(frozen=True)
class Grains:
    """A packing, in the file's own units.

    positions : (n, 3) float64
    diameters : (n,) float64, or None where the file has none
    density : of the grains' material, or None
    where : what it was read from, for messages
    """

    positions: np.ndarray
    diameters: np.ndarray
    density: float
    where: str


def table_of(path, rows, names, wanted):
    """The wanted columns of the rows, (n, len(wanted)) float64.

    rows : (number of the line, its words); names : of the columns, in their order

    Raises DumpError that names line and column.
    """
    if not rows:
        raise DumpError(f"{path}: there is no grain in it")
    places = [names.index(name) for name in wanted]
    values = np.empty((len(rows), len(wanted)))
    for row, (number, words) in enumerate(rows):
        if len(words) != len(names):
            raise DumpError(f"{path}, line {number}: expected {len(names)} columns ({' '.join(names)}), found {len(words)}: "
                            f"'{' '.join(words)[:60]}'")
        for column, place in enumerate(places):
            try:
                values[row, column] = float(words[place])
            except ValueError:
                raise DumpError(f"{path}, line {number}: column '{wanted[column]}' is no number: '{words[place]}'") from None
    bad = np.argwhere(~np.isfinite(values))
    if bad.size:
        row, column = bad[0]
        raise DumpError(f"{path}, line {rows[row][0]}: column '{wanted[column]}' is not finite: '{rows[row][1][places[column]]}'")
    return values


def check_diameters(path, diameters):
    """Raise DumpError unless all are positive."""
    if diameters is not None and not (diameters > 0).all():
        raise DumpError(f"{path}: a grain has a diameter of {diameters[~(diameters > 0)][0]:g}, which must be positive")
    return diameters
