# SPDX-License-Identifier: GPL-2.0-or-later
"""The header of a frame in a dump: its items up to the names of the columns."""

import re

import numpy as np

TILTS = ["xy", "xz", "yz"]


def read_header(lines):
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
        read_item(lines, line[len("ITEM: "):], header)
    for item in ("TIMESTEP", "NUMBER OF ATOMS", "BOX BOUNDS"):
        if item not in header:
            raise lines.error(f"'ITEM: ATOMS' without an 'ITEM: {item}' before it")
    return header


def read_item(lines, item, header):
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
