# SPDX-License-Identifier: GPL-2.0-or-later
"""examples/half-full/in.half_full_spot: a flat base to its end, cones a short stretch."""

import json
import subprocess
import sys

import pytest

from lammps_runs import ROOT, run_example


def run_half_full(out, **variables):
    """What the program said."""
    return run_example("half-full", "in.half_full_spot", out, **variables)


def test_a_heap_stays_on_a_flat_base(tmp_path):
    """The bounds are four times what seeds differ by, and more."""
    run_half_full(tmp_path / "run")
    kept = tmp_path / "kept.json"
    said = subprocess.run([sys.executable, "-B", ROOT / "analysis" / "round_heap.py", tmp_path / "run", "-o", kept],
                          capture_output=True, text=True, timeout=60)
    assert said.returncode == 0, said.stderr
    found = {name: value for name, (value, _) in json.loads(kept.read_text())["quantities"].items()}
    assert found["left_0tau"] == 5662
    assert found["left_80tau"] == pytest.approx(1789, rel=0.08)  # DEM's
    assert 900 < found["left_end"] < 1110
    assert 15 < found["angle_end"] < 25
    assert found["left_in_last_20tau"] < 150


@pytest.mark.parametrize("angle, grains, height", [(30, 5794, 13.8564), (60, 5155, 4.6188)])
def test_the_deck_drains_cones(tmp_path, angle, grains, height):
    said = run_half_full(tmp_path, angle=angle, outflow=60, time=0.14)  # 8 tau, up to whole snapshots: 10
    scene = json.loads((tmp_path / "scene.json").read_text())
    assert scene["cone_height"] == pytest.approx(0.003 * height, rel=1e-5)
    left = int(said.split("Loop time")[1].split(" with ")[1].split()[0])
    assert grains - 660 < left < grains - 520
