# SPDX-License-Identifier: GPL-2.0-or-later
"""examples/python/drive_fix.py, in a process of its own: LAMMPS ends it if something is wrong."""

import importlib.util
import os
import pathlib
import re
import subprocess
import sys

import pytest

EXAMPLE = pathlib.Path(__file__).resolve().parents[2] / "examples" / "python"


@pytest.mark.skipif(importlib.util.find_spec("lammps") is None,
                    reason="needs LAMMPS' Python module (Debian: apt install python3-lammps)")
def test_it_drains_the_hopper():
    done = subprocess.run([sys.executable, "drive_fix.py"], cwd=EXAMPLE, capture_output=True, text=True, timeout=300,
                          env=os.environ)
    assert done.returncode == 0, done.stdout + done.stderr
    found = re.findall(r"^ *([\d.]+) tau: +(\d+) grains have left, (\d+) are there", done.stdout, re.M)
    rows = [(float(tau), int(left), int(there)) for tau, left, there in found]
    assert [row[0] for row in rows] == [5.0, 10.0, 15.0, 20.0]
    assert all(left + there == 8000 for _, left, there in rows)
    # 5,700 leave in a second, 100 in a tau; the first of them some tau later.
    assert rows[-1][1] == pytest.approx(2000, rel=0.1)
