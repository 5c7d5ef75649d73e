# SPDX-License-Identifier: GPL-2.0-or-later
"""One frame of a dump: which columns are read, the table, and its checks."""

from dataclasses import dataclass, field
from fnmatch import fnmatchcase

import numpy as np

from .header import read_header

AXES = "xyz"


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


def read_frame(lines, extra):
    """The next frame, or None at the end of the file."""
    header = read_header(lines)
    if header is None:
        return None
    count, columns = header["NUMBER OF ATOMS"], header["ATOMS"]
    return frame_of(header, lambda wanted: _read_table(lines, count, columns, wanted), lines, extra)


def frame_of(header, table_of, source, extra):
    """The frame of a header, as of ``read_header``; table_of(wanted) : its atoms' columns of these names, (n, wanted);
    source : makes the errors, by error(message)."""
    columns = header["ATOMS"]
    if "id" not in columns:
        raise source.error(f"column 'id' is missing (the columns are: {' '.join(columns) or 'none'})")
    coordinates = [_coordinate(axis, periodic, columns, source) for axis, periodic in zip(AXES, header["PERIODIC"])]
    optional = [name for name in columns if name in extra or any(fnmatchcase(name, pattern) for pattern in extra)]
    wanted = ["id", *(name for one in coordinates for name in one.names()), *optional]
    table = table_of(wanted)
    table = table[np.argsort(table[:, 0], kind="stable")]
    named = dict(zip(wanted, table.T))
    ids = _whole(named["id"], "id", source)
    _check_unique(ids, source)
    positions = np.stack([one.values(named, bounds, source) for one, bounds in zip(coordinates, header["BOX BOUNDS"])], axis=1)
    _check_finite(ids, positions, source)
    return Frame(header["TIMESTEP"], ids, positions, header["BOX BOUNDS"], {name: named[name] for name in optional})


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

    def values(self, named, bounds, source):
        """(n,) from the columns by name and the box's bounds (2,) along the axis."""
        low, high = bounds
        values = low + named[self.column] * (high - low) if self.scaled else named[self.column]
        return values + _whole(named[self.image], self.image, source) * (high - low) if self.image else values


def _coordinate(axis, periodic, columns, source):
    """The _Coordinate of ``axis``; raises DumpError where no column tells it."""
    plain, scaled = axis, f"{axis}s"
    unwrapped, unwrapped_scaled, image = f"{axis}u", f"{axis}su", f"i{axis}"
    order = (unwrapped, unwrapped_scaled, plain, scaled) if periodic else (plain, unwrapped, scaled, unwrapped_scaled)
    column = next((name for name in order if name in columns), None)
    if column is None:
        raise source.error(f"column '{axis}' is missing (the columns are: {' '.join(columns)}; positions are wanted as "
                          "x y z, xu yu zu, xs ys zs, xsu ysu zsu)")
    wrapped = periodic and column in (plain, scaled)
    if wrapped and image not in columns:
        raise source.error(f"the box is periodic along {axis}, where column '{column}' alone does not tell how far grains "
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


def _whole(values, column, source):
    """The values (n,) as int64; raises DumpError where one is no whole number."""
    with np.errstate(invalid="ignore"):  # NaN is no whole number either
        whole = values.astype(np.int64)
    if not np.array_equal(whole, values):
        raise source.error(f"column '{column}' holds values that are no whole numbers (frame ending here)")
    return whole


def _check_unique(ids, source):
    repeated = np.flatnonzero(np.diff(ids) == 0)
    if repeated.size:
        raise source.error(f"grain id {ids[repeated[0]]} stands twice in the frame ending here")


def _check_finite(ids, positions, source):
    bad = np.flatnonzero(~np.isfinite(positions).all(axis=1))
    if bad.size:
        raise source.error(f"position of grain {ids[bad[0]]} is not finite in the frame ending here "
                          f"({bad.size} such grains)")
