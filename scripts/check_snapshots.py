#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""check_snapshots.py FOLDER NUMBER: have so many snapshots of in.silo_spot, all whole, been written to the folder?

LAMMPS doesn't notice when a disk is full: it ends as if all were well. Exits with 1 and one line if not.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "analysis"))

from spot_analysis.base.errors import DumpError  # noqa: E402  (beside this folder)
from spot_analysis.reading.dump import read_file  # noqa: E402


def main(folder, number):
    paths = sorted(pathlib.Path(folder).glob("drain.*.dump.*"))
    if len(paths) != int(number):
        return f"{folder} holds {len(paths)} snapshots instead of {number}: is the disk full?"
    for path in paths:
        try:
            for _ in read_file(str(path)):
                pass
        except DumpError as error:
            return f"{error}; is the disk full?"
    return None


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(f"usage: {__doc__.splitlines()[0].split(':')[0]}")
    if reason := main(*sys.argv[1:]):
        sys.exit(f"error: {reason}")
