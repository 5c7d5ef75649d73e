# SPDX-License-Identifier: GPL-2.0-or-later
"""Walls made of shapes, several outlets with rates and schedules of their own, and rates by Beverloo's law."""

import re

import numpy as np
import pytest

from lammps_runs import (FIX, OPENING, WALLS, deck, drain, error_of, lattice, needs_mpirun, on_ranks, read_dump, run_ok, thermo,
                         write_data)

HOPPER = "walls add cone z 0 0 3 6 0 5 walls add cylinder z 0 0 6 5 20"
TWO = "box -9 9 -4 4 slot -5 0 0 5.4 8 orifice 5 0 0 3"
WIDE = (-9, 9, -6, 6, -4, 20)


def fix(walls_and_outlets, rates="injection 60 60", more=""):
    return f"fix drain all spot {walls_and_outlets} influence 1e-2 speed 3.2 {rates} seed 1 {more}"


def write_wide(folder):
    """A packing 18 d wide in `folder`."""
    folder.mkdir(exist_ok=True)
    edge = 1.218
    points = np.stack(np.meshgrid(*3 * [np.arange(-12, 13)], indexing="ij"), axis=-1).reshape(-1, 3) * edge
    points = np.concatenate([points, points + edge / 2]) + (0.1, 0.05, 0.3)
    x, y, z = points.T
    write_data(folder / "packing.data", points[(abs(x) <= 8.5) & (abs(y) <= 3.5) & (z >= 0.5) & (z <= 10)], box=WIDE)


def test_a_block_drains_as_a_box(tmp_path):
    drain(tmp_path / "box")
    drain(tmp_path / "block", fix=FIX.replace(WALLS, "walls add block -5 5 -4 4 0 30"))
    box, block = read_dump(tmp_path / "box" / "grains.dump"), read_dump(tmp_path / "block" / "grains.dump")
    assert len(box) == len(block) == 4
    for (_, one), (_, other) in zip(box, block):
        assert (one["id"] == other["id"]).all()
        np.testing.assert_allclose(one["z"], other["z"], atol=2e-3)  # at the rim of the orifice they are pushed off otherwise


def test_a_cone_drains_and_keeps_its_grains(tmp_path):
    inside = lambda x, y, z: np.hypot(x, y) <= min(3 + 0.6 * z, 6) - 0.62
    tmp_path.joinpath("hopper").mkdir()
    write_data(tmp_path / "hopper" / "packing.data", lattice(inside), box=(-6, 6, -6, 6, -4, 20))
    drain(tmp_path / "hopper", fix=fix(HOPPER + " " + OPENING, "injection 60"), run="run 60")
    found = [frame for _, frame in read_dump(tmp_path / "hopper" / "grains.dump")]
    assert len(found[-1]["id"]) < len(found[0]["id"]) - 20
    for frame in found:
        radius = np.hypot(frame["x"], frame["y"])
        above = frame["z"] >= 0
        # Half a grain inside the cone, whose wall is 1.166 times as far along r as across; overlaps of 0.3 at most.
        assert (radius - np.minimum(3 + 0.6 * frame["z"], 6))[above].max() < 0.0


@needs_mpirun
def test_outlets_count_and_close(tmp_path):
    one, two = tmp_path / "one", tmp_path / "two"
    for folder in (one, two):
        write_wide(folder)
    command = fix(TWO, more="schedule 1 0 0 2 1 schedule 2 2 0")
    out = thermo(run_ok(deck(command, run="run 80"), one))
    closed = out["Step"] <= 20
    assert (out["f_drain[9]"][closed] == 0).all(), "the first outlet is closed up to 2 tau"
    assert out["f_drain[10]"][closed][-1] > 0
    assert out["f_drain[9]"][-1] > 0
    assert (out["f_drain[9]"] + out["f_drain[10]"] == out["f_drain[3]"]).all()
    run_ok(deck(command, run="run 80"), two, launcher=on_ranks(3))
    assert (one / "grains.dump").read_bytes() == (two / "grains.dump").read_bytes()


def test_counts_of_outlets_go_on_from_a_restart_file(tmp_path):
    write_wide(tmp_path)
    command = fix(TWO, more="schedule 1 0 0 2 1")
    whole = thermo(run_ok(deck(command, run="run 60"), tmp_path))
    run_ok(deck(command, run="run 30\nwrite_restart half.restart"), tmp_path)
    half = deck(command, run="run 30").replace("read_data packing.data", "read_restart half.restart")
    rest = thermo(run_ok(half, tmp_path))
    for outlet in ("f_drain[9]", "f_drain[10]"):
        assert rest[outlet][-1] == whole[outlet][-1] > 0
    other = half.replace("schedule 1 0 0 2 1", "schedule 1 0 0 3 1")
    error = error_of(other, tmp_path)
    assert "injection was 60 60; schedule 1 0 0 2 1" in error and "give the fix another ID" in error


@needs_mpirun
def test_births_follow_the_outflow_on_ranks_and_over_restarts(tmp_path):
    one, two = tmp_path / "one", tmp_path / "two"
    for folder in (one, two):
        write_wide(folder)
    command = fix(TWO, rates="outflow 12 6", more="volume 77")
    out = thermo(run_ok(deck(command, run="run 250"), one))
    run_ok(deck(command, run="run 120\nwrite_restart part.restart"), two, launcher=on_ranks(2))
    rest = deck(command, run="run 130").replace("read_data packing.data", "read_restart part.restart")
    run_ok(rest, two, launcher=on_ranks(3))
    (_, whole), (_, parts) = read_dump(one / "grains.dump")[-1], read_dump(two / "grains.dump")[-1]
    assert all((whole[column] == parts[column]).all() for column in whole)
    last, before = out["Step"] == 250, out["Step"] == 100
    for outlet, asked in (("f_drain[9]", 12), ("f_drain[10]", 6)):
        found = (out[outlet][last] - out[outlet][before])[0] / 15
        # Births are at random, 120 and 230 of them: by 9 and 6 % more or less.
        assert abs(found - asked) < 0.1 * asked, f"{outlet}: {found} a unit of time, asked for {asked}"


def test_beverloos_law_is_told(tmp_path):
    out = run_ok(deck(FIX.replace("injection 100", "beverloo 1").replace(OPENING, "orifice 0 0 0 2.8"), run="run 1"), tmp_path)
    # 0.58 * 0.58 * 6 / pi * (5.6 - 1.4)^2.5
    assert "Beverloo's law predicts an outflow of 23.2263" in out, out[-2000:]
    assert "orifice of radius 2.8" in out and "below 6 grains may clog" in out
    assert "outlets of 6 diameters or more, silos wider than 2.5 outlets" in out
    assert "nearest wall is 4 diameters from the middle of the orifice of radius 2.8" in out and "is for 17.8 or more" in out
    assert re.search(r"the bed above the orifice of radius 2.8 at \(0, 0, 0\) is [\d.]+ diameters deep: .* is for 11\.2 or more", out)


@needs_mpirun
def test_births_are_told_for_the_outflow_that_is_told(tmp_path):
    """Whatever the schedule, of each outlet by itself."""
    write_wide(tmp_path)
    command = fix(TWO, rates="beverloo 1", more="volume 77 schedule 2 0 0.5 1 3")
    for ranks in (1, 3):
        out = run_ok(deck(command, run="run 1"), tmp_path, launcher=on_ranks(ranks))
        told = re.findall(r"outflow of (\S+) grains per time through the (slot|orifice).*, by (\S+) births of spots per time(.*)", out)
        assert [one[1] for one in told] == ["slot", "orifice"]
        for outflow, _, births, _ in told:
            assert float(births) == pytest.approx(float(outflow) / (1e-2 * 77), rel=1e-4)
        assert told[0][3] == "" and "factor of its schedule is 1" in told[1][3]
        assert out.count("Beverloo's law is for flat bases") == 1 and out.count("diameters deep") == 2


@pytest.mark.parametrize("command, said", [
    (FIX.replace(WALLS, "walls add block -9 5 -4 4 0 30"), "not within the simulation box"),
    (FIX.replace(WALLS, "walls add block -5 5 -4 4 0 30 walls cut block -3 3 -3 3 0 1"), "orifice of radius 3"),
    (FIX.replace("injection 100", "injection 50 50"), "2 rates but there is 1"),
    (fix("region silo orifice -4 0 0 3 orifice 4 0 0 3"), "'region' takes one round orifice"),
    (FIX.replace(OPENING, "slot 0 0 0 12 8"), "slot of 12 by 8")])
def test_mistakes_are_named(tmp_path, command, said):
    assert said in error_of(deck(command), tmp_path)
