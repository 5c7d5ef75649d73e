# SPDX-License-Identifier: GPL-2.0-or-later
"""Dry runs, which the variable spot_dry_run asks for: what they say against what a run does, and what they leave alone."""

import json

import numpy as np
import pytest

from lammps_runs import FIX, HALF_WIDTH, HEIGHT, ORIFICE, deck, error_of, lattice, on_ranks, needs_mpirun, programs, run, run_ok, thermo, write_data

SLOW = FIX.replace("influence 1e-2", "influence 1e-3")  # the surface hardly sinks
DRY = "variable spot_dry_run index dry.json"


def dry(folder, **parts):
    run_ok(deck(before=DRY + "\n" + parts.pop("before", ""), **parts), folder)
    return json.loads((folder / "dry.json").read_text())


@programs
def test_it_ends_before_the_run_and_writes_no_dump(tmp_path, program):
    (tmp_path / "grains.dump").write_text("of a run before")
    said = run_ok(deck(before=DRY), tmp_path, program=program)
    assert "fix spot: a dry run, written to dry.json" in said and "Loop time" not in said
    assert (tmp_path / "grains.dump").read_text() == "of a run before"
    found = json.loads((tmp_path / "dry.json").read_text())
    assert found["format"] == 1 and found["grains"] == len(lattice()) and found["diameter"] == 1 and found["steps"] == 30
    assert found["smallest"] == found["largest"] == 1 and found["recirculates"] is False
    assert found["timestep"] == 0.1 and found["units"] == "lj" and found["memory"] > 1e5


@pytest.mark.parametrize("fix", [SLOW, SLOW + " dilation 0.003"], ids=["one speed", "dilating"])
def test_spots_and_moves_are_those_of_a_run(tmp_path, fix):
    """At 8 to 10 tau of a run, when the first spots have left: within a tenth."""
    found = dry(tmp_path, fix=fix)
    log = thermo(run_ok(deck(fix=fix, run="run 100"), tmp_path))
    spots, moves = log["f_drain[1]"][-5:].mean(), np.polyfit(log["Step"][-5:] * 0.1, log["f_drain[2]"][-5:], 1)[0]
    assert found["steady"]
    assert found["spots"] == pytest.approx(spots, rel=0.1)
    assert found["moves_per_time"] == pytest.approx(moves, rel=0.1)
    (outlet,) = found["outlets"]
    assert outlet["births"] == 100 and outlet["half_widths"] == [ORIFICE, ORIFICE] and outlet["centre"] == [0, 0, 0]


def test_unequal_grains_leave_as_they_are_asked_to(tmp_path):
    """In grains of mean volume; V_s is what leaves for each birth."""
    diameters = np.where(np.arange(len(lattice())) % 3 == 0, 1.0, 0.6)
    write_data(tmp_path / "packing.data", lattice(), diameters=diameters)
    found = dry(tmp_path, fix=FIX.replace("injection 100", "outflow 40 volume 20"))
    grain = np.pi / 6 * np.mean(diameters**3)
    assert found["diameter"] == pytest.approx(np.cbrt(np.mean(diameters**3)))
    assert found["smallest"] == pytest.approx(0.6) and found["largest"] == 1
    (outlet,) = found["outlets"]
    assert outlet["outflow"] == pytest.approx(40) and outlet["births"] * found["spot_volume"] == pytest.approx(40 * grain)


def test_slices_show_walls_and_grains(tmp_path):
    found = dry(tmp_path)
    across_y, across_x = found["slices"]
    inside = np.array([[cell == "1" for cell in row] for row in across_y["inside"]])
    x, z = (low + (np.arange(n) + 0.5) * (high - low) / n
            for low, high, n in zip(across_y["low"], across_y["high"], inside.shape[::-1]))
    assert across_y["low"][0] == -HALF_WIDTH - 1 and across_y["across"] == "y" and across_x["across"] == "x"
    expected = (abs(x) < HALF_WIDTH) & (z > 0)[:, None]
    above = z > 0.25
    assert np.array_equal(inside[above], expected[above])
    points = lattice()
    cut = points[abs(points[:, 1]) < 0.5]
    assert np.allclose(np.sort(np.array(across_y["grains"]), axis=0), np.sort(cut[:, [0, 2]], axis=0), atol=1e-5)


def test_ways_begin_below_the_outlet_and_end_above_the_grains(tmp_path):
    ways = [np.array(way) for way in dry(tmp_path)["ways"]]
    assert len(ways) == 12
    for way in ways:
        assert way[0, 2] < 0 and (np.diff(way[:, 2]) > 0).all() and abs(way[:, 0]).max() < HALF_WIDTH
        assert np.hypot(*way[0, :2]) < ORIFICE
    assert max(way[-1, 2] for way in ways) > HEIGHT


def test_walls_of_shapes_and_regions(tmp_path):
    shapes = "walls add block -5 5 -4 4 0 19"
    region = "region silo block -5 5 -4 4 0 19\nregion pipe cylinder z 0 0 3 -4 1e-3\nregion both union 2 silo pipe"
    rates = "orifice 0 0 0 3 influence 1e-2 speed 3.2 injection 100"
    box = dry(tmp_path)
    for fix, before in ((f"fix drain all spot {shapes} {rates}", ""), (f"fix drain all spot region both {rates}", region)):
        found = dry(tmp_path, fix=fix, before=before)
        above = [row for row in range(len(box["slices"][0]["inside"])) if box["slices"][0]["low"][1] + row * 0.25 > 0.5][:60]
        assert [found["slices"][0]["inside"][row] for row in above] == [box["slices"][0]["inside"][row] for row in above]
        assert found["spots"] == pytest.approx(box["spots"], rel=0.15)


def test_in_the_order_of_time_too(tmp_path):
    found = dry(tmp_path, fix=FIX + " accuracy exact")
    assert found["time_ordered"] and found["step_height"] == pytest.approx(0.1)
    assert found["moves_per_time"] == pytest.approx(found["spots"] * 3.2 / 0.1, rel=0.1)


def test_a_deck_that_a_run_refuses(tmp_path):
    points = lattice()
    points[1] = points[0] + [0, 0, 0.5]
    write_data(tmp_path / "packing.data", points)
    errors = [error_of(deck(before=before), tmp_path).rpartition(" (")[0] for before in (DRY, "")]  # without the line of the source
    assert errors[0] == errors[1] and "overlap" in errors[0]
    assert not (tmp_path / "dry.json").exists()


def test_a_file_that_cannot_be_written(tmp_path):
    assert "cannot write absent/dry.json" in error_of(deck(before=DRY.replace("dry.json", "absent/dry.json")), tmp_path)


@needs_mpirun
def test_one_rank_only(tmp_path):
    done = run(deck(before=DRY), tmp_path, launcher=on_ranks(2))
    assert done.returncode != 0 and "is for 1 MPI rank" in done.stdout + done.stderr
