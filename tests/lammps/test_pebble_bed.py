# SPDX-License-Identifier: GPL-2.0-or-later
"""examples/pebble-bed/in.pebble_bed, a short stretch of it, and what its script refuses."""

import gzip
import subprocess
import sys

import numpy as np
import pytest
from scipy.spatial import cKDTree

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


def test_a_bed_goes_on_from_its_restart_file(tmp_path):
    run_example("pebble-bed", "in.pebble_bed", tmp_path, turnovers=0.02, save=4)
    last = tmp_path / "bed.8.dump.zst"
    expected = last.read_bytes()
    last.unlink()
    run_example("pebble-bed", "in.pebble_bed", tmp_path, turnovers=0.02, resume=4)
    assert last.read_bytes() == expected


def make_packing(*words):
    return subprocess.run([sys.executable, "-B", ROOT / "examples" / "pebble-bed" / "make_packing.py", *map(str, words)],
                          capture_output=True, text=True, timeout=100)


def test_the_whole_reactor_is_put_together(tmp_path):
    packing = tmp_path / "whole.data.gz"
    assert make_packing(30, packing).returncode == 0
    with gzip.open(packing, "rt") as lines:
        places = np.loadtxt([line for line in lines if line.count(" ") == 6], usecols=(4, 5, 6)) / 0.003
    assert len(places) == 440_000
    r, z = np.hypot(places[:, 0], places[:, 1]), places[:, 2]
    slope = np.radians(30)
    assert r.max() < 28.5 and z.min() > 0.45 and ((4 - r) * np.cos(slope) + z * np.sin(slope)).min() > 0.5
    nearest = cKDTree(places).query(places, k=2)[0][:, 1]
    assert nearest.min() > 0.98
    # Loose at seams and at the cut walls only.
    assert ((r < 20) & (z > 60) & (z < 140)).sum() * np.pi / 6 / (np.pi * 20**2 * 80) > 0.595


@pytest.mark.parametrize("words, error", [(["x"], "invalid float"), ([4], "from 5 to 85"), ([0], "from 5 to 85")])
def test_what_it_refuses(words, error, tmp_path):
    done = make_packing(*words, tmp_path / "whole.data.gz")
    assert done.returncode == 2 and error in done.stderr
