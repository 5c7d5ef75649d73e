# SPDX-License-Identifier: GPL-2.0-or-later
"""examples/pebble-bed/in.pebble_bed, a short stretch of it, and what its script refuses."""

import os
import subprocess
import sys

import pytest

from lammps_runs import FRONT_END, PLUGIN, ROOT, thermo

PEBBLES = ROOT / "examples" / "pebble-bed"


@pytest.fixture(scope="module")
def short_run(tmp_path_factory):
    out = tmp_path_factory.mktemp("bed") / "post"
    words = ["-var", "out", str(out), "-var", "turnovers", "0.04"]
    done = subprocess.run([FRONT_END, "-in", "in.pebble_bed", "-log", "none", "-nocite", *words], cwd=PEBBLES,
                          env={**os.environ, "SPOT_PLUGIN": PLUGIN}, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    return done.stdout, out


def test_pebbles_go_round(short_run):
    log = thermo(short_run[0])
    assert (log["Atoms"] == 12000).all() and log["f_bed[3]"][-1] > 300 and log["f_bed[6]"].max() < 0.02 * 0.06


def test_the_script_reads_its_dumps(short_run):
    done = subprocess.run([sys.executable, "-B", "residence.py", short_run[1]], cwd=PEBBLES, capture_output=True, text=True, timeout=100)
    assert done.returncode != 0 and "0.04 turnovers, but two are needed" in done.stderr
