# SPDX-License-Identifier: GPL-2.0-or-later
"""examples/pebble-bed/in.pebble_bed, a short stretch of it, and what its script refuses."""

import subprocess
import sys

import pytest

from lammps_runs import ROOT, run_example, thermo


@pytest.fixture(scope="module")
def short_run(tmp_path_factory):
    out = tmp_path_factory.mktemp("bed") / "post"
    return run_example("pebble-bed", "in.pebble_bed", out, turnovers=0.04), out


def test_pebbles_go_round(short_run):
    log = thermo(short_run[0])
    assert (log["Atoms"] == 12000).all() and log["f_bed[3]"][-1] > 300 and log["f_bed[6]"].max() < 0.02 * 0.06


def test_the_analysis_reads_its_dumps(short_run):
    done = subprocess.run([sys.executable, "-B", ROOT / "analysis" / "turnovers.py", short_run[1]], capture_output=True, text=True,
                          timeout=100)
    assert done.returncode == 1 and "turnovers, but --to is 3" in done.stderr


def test_the_steep_funnel_starts(tmp_path):
    log = thermo(run_example("pebble-bed", "in.pebble_bed", tmp_path / "post", turnovers=0.005, angle=30, outflow=84))
    assert (log["Atoms"] == 12000).all() and log["f_bed[3]"][-1] > 20
