# SPDX-License-Identifier: GPL-2.0-or-later
"""Writes examples/silo/dumps.sha256 and tests/lammps/dumps.sha256 anew, from our lmp: after a change that changes trajectories on
purpose.

    /usr/bin/python3 tests/lammps/record_checksums.py
"""

import pathlib
import tempfile

import test_checksums
import test_example
from lammps_runs import FRONT_END

if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place)
        dumps = test_example.run_example(FRONT_END, folder / "out", time=test_example.RECORDED_TIME)
        test_example.CHECKSUMS.write_text(test_example.checksums(dumps))
        lines = []
        for scene in test_checksums.SCENES:
            (folder / scene).mkdir()
            lines.append(f"{test_checksums.checksum(scene, folder / scene, ranks=1)}  {scene}\n")
        test_checksums.CHECKSUMS.write_text("".join(lines))
