#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""check_snapshots.py FOLDER NUMBER: have so many snapshots of in.silo_spot, all whole, been written to the folder?

LAMMPS doesn't notice when a disk is full: it ends as if all were well. Exits with 1 and one line if not.
"""

import pathlib
import sys

import zstandard


def what_is_wrong(path):
    """Of one compressed text dump with one frame; None if nothing is."""
    try:
        with zstandard.open(path, "rb") as handle:
            text = handle.read()
    except zstandard.ZstdError as error:
        return f"is damaged ({error})"
    lines = text.splitlines()
    whole = text.endswith(b"\n") and len(lines) >= 9 and len(lines) == 9 + int(lines[3])
    return None if whole else f"is cut off after {len(lines)} lines"


def main(folder, number):
    paths = sorted(pathlib.Path(folder).glob("drain.*.dump.zst"))
    if len(paths) != int(number):
        return f"{folder} holds {len(paths)} snapshots instead of {number}: is the disk full?"
    for path in paths:
        if wrong := what_is_wrong(path):
            return f"{path} {wrong}: is the disk full?"
    return None


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(f"usage: {__doc__.splitlines()[0].split(':')[0]}")
    if reason := main(*sys.argv[1:]):
        sys.exit(f"error: {reason}")
