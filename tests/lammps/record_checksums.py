# SPDX-License-Identifier: GPL-2.0-or-later
"""Writes examples/silo/dumps.sha256 anew, from our lmp: after a change that changes trajectories on purpose.

    /usr/bin/python3 tests/lammps/record_checksums.py
"""

import pathlib
import tempfile

from test_example import CHECKSUMS, RECORDED_TIME, checksums, run_example
from lammps_runs import FRONT_END

if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        CHECKSUMS.write_text(checksums(run_example(FRONT_END, pathlib.Path(folder) / "out", time=RECORDED_TIME)))
