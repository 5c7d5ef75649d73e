# SPDX-License-Identifier: GPL-2.0-or-later
"""examples/periodic-slot, examples/two-outlets and examples/benchmark-silo, a short stretch of each, on their real packings."""

import json

import numpy as np
import pytest
import zstandard

from lammps_runs import read_dump, run_example
from near_dem import assert_near_dem


def run_deck(folder, deck, out, **variables):
    """Snapshots of the deck, and what the program said."""
    said = run_example(folder, deck, out, **variables)
    frames = [read_dump(path)[0] for path in sorted(out.glob("drain.*.dump"), key=lambda path: int(path.suffixes[-2][1:]))]
    return [frame for _, frame in frames], said


def test_the_slot_drains_by_its_law_and_only_through_the_slot(tmp_path):
    frames, said = run_deck("periodic-slot", "in.slot", tmp_path / "out", tau_run=3)
    assert "predicts an outflow of 17700" in said  # 309.5 a tau
    first, last = frames[0], frames[-1]
    assert len(first["id"]) == 15400 and 100 < 15400 - len(last["id"]) < 3 * 400
    gone = ~np.isin(first["id"], last["id"])
    assert np.abs(first["x"][gone]).max() < 0.003 * 6


def test_the_slot_flows_as_dem_does(tmp_path):
    """In the README: within 1 % at 5 d and 2 % at 10 d over the slot, - 9 % beside it at 15 d, + 2.4 % in packing fraction."""
    run_deck("periodic-slot", "in.slot", tmp_path / "out", tau_run=8, outflow=271)
    assert_near_dem(tmp_path / "out", "periodic-slot/dem.json", (4, 8), {
        "outflow": 0.06, "speed_5d_x1.0d": 0.16, "speed_10d_x1.0d": 0.17, "speed_15d_x5.0d": 0.24, "packing_fraction": 0.075})


def test_the_left_outlet_flows_as_dem_does(tmp_path):
    """In the README: - 10 % over it at 5 d, - 11 % at 10 d, + 0.8 % in packing fraction."""
    run_deck("two-outlets", "in.two_outlets", tmp_path / "out", tau_run=10, outflow=71)
    assert_near_dem(tmp_path / "out", "two-outlets/dem-left.json", (4, 10), {
        "outflow": 0.06, "outflow_at_x-12.5d": 0.06, "speed_5d_x-12.0d": 0.25, "speed_10d_x-12.0d": 0.26, "packing_fraction": 0.06})


@pytest.mark.parametrize("first, second, gone_from", [(9, 10, [-1]), (0.01, 9, [1]), (0.01, 0.02, [-1, 1])])
def test_outlets_open_and_close(tmp_path, first, second, gone_from):
    frames, _ = run_deck("two-outlets", "in.two_outlets", tmp_path / "out", tau_run=3, first=first, second=second, outflow=70)
    gone = ~np.isin(frames[0]["id"], frames[-1]["id"])
    assert np.count_nonzero(gone) > 50
    assert sorted(set(np.sign(frames[0]["x"][gone]))) == gone_from


def test_the_communitys_silo_is_a_hopper_of_other_numbers(tmp_path):
    out = tmp_path / "out"
    run_deck("benchmark-silo", "in.benchmark_silo", out, time=0.12)
    scene = json.loads((out / "scene.json").read_text())
    assert scene["cylinder_radius"] == pytest.approx(0.1) and scene["orifice_radius"] == pytest.approx(0.03)
    assert scene["cone_height"] == pytest.approx(0.0554222, rel=1e-5) and scene["grains"] == 40000
    left = int(zstandard.open(out / "drain.4.dump.zst", "rb").read().split(b"\n")[3])
    assert 40000 - left == pytest.approx(438.9 * (2 - 0.59), rel=0.15)  # in 2 tau; spots take R_s / v_s to the outlet
    # To 6 tau. In the README: + 1.5 % in outflow, + 34 % on the axis at 5 d and + 15 % at 10 d, - 24 % in residence.
    assert_near_dem(out, "benchmark-silo/dem-60.json", (2, 6), {
        "outflow": 0.07, "speed_5d_r1.0d": 0.49, "speed_5d_r7.0d": 0.21, "speed_10d_r1.0d": 0.30})
