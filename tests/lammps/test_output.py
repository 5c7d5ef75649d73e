# SPDX-License-Identifier: GPL-2.0-or-later
"""What the fix says: grains that leave, velocities, the global vector, the spots."""

import json
import re
import sys

import numpy as np
import pytest

from lammps_runs import (FIX, HALF_DEPTH, HALF_WIDTH, LOAD_SPOT, ORIFICE, ROOT, deck, error_of, lattice, needs_mpirun, on_ranks,
                         positions, programs, read_dump, run_ok, thermo, write_data)

sys.path.insert(0, str(ROOT / "analysis"))
from spot_analysis.reading.scene import load_scene  # noqa: E402

# f_drain[1] to f_drain[8]
SPOTS, MOVES, DRAINED, MASS, OUTFLOW, OVERLAP, SWEEPS, LEFT = (f"f_drain[{k}]" for k in range(1, 9))
DUMP_SPOTS = "dump spots all local 1 spots.dump f_drain[1] f_drain[2] f_drain[3] f_drain[4] f_drain[5] f_drain[6]"


@pytest.fixture(scope="module")
def drained(tmp_path_factory):
    """Thermo columns, frames of the grains (every step) and frames of the spots of one drainage."""
    folder = tmp_path_factory.mktemp("drained")
    screen = run_ok(deck(fix=FIX + " average 10 dz 0.4", run="run 30",
                         after=f"dump_modify grains every 1\nthermo 1\n{DUMP_SPOTS}"), folder)
    return thermo(screen), read_dump(folder / "grains.dump"), read_dump(folder / "spots.dump")


def test_drained_grains_vanish_below_the_outlet(drained):
    _, frames, _ = drained
    lowest = min(frame["z"].min() for _, frame in frames)
    assert 0 <= lowest < 0.3  # outlet: the height of the orifice
    seen = frames[0][1]["id"]
    for (_, before), (_, after) in zip(frames, frames[1:]):
        gone = ~np.isin(before["id"], after["id"])
        assert np.isin(after["id"], before["id"]).all()
        assert (before["z"][gone] < 0.5).all()  # a step moves a grain by far less than a diameter
    assert len(seen) - len(frames[-1][1]["id"]) > 30


def test_counts_agree(drained):
    log, frames, _ = drained
    left = np.array([len(frame["id"]) for _, frame in frames])
    assert (log["Atoms"] == left).all()
    assert (log[DRAINED] == left[0] - left).all()
    assert log[MASS] == pytest.approx(log[DRAINED] * np.pi / 6)
    averaged = np.minimum(np.arange(len(left)), 10)
    earlier = log[DRAINED][np.arange(len(left)) - averaged]
    assert log[OUTFLOW][1:] == pytest.approx(((log[DRAINED] - earlier)[1:] / (averaged[1:] * 0.1)))


def test_largest_overlap(drained):
    log, frames, _ = drained
    for k, (_, frame) in list(enumerate(frames))[::6]:
        x = positions(frame)
        squared = ((x[:, None] - x)**2).sum(axis=2)
        np.fill_diagonal(squared, 1)
        assert log[OVERLAP][k] == pytest.approx(max(0, 1 - np.sqrt(squared.min())), abs=1e-9)
    assert 0 < log[OVERLAP].max() < 0.05


def test_moves_and_sweeps(drained):
    log, _, spots = drained
    assert (np.diff(log[MOVES]) >= 0).all() and (np.diff(log[SWEEPS]) >= 0).all() and log[SWEEPS][-1] > 30
    # None has reached the top yet: every step that was ever taken is still counted by a spot.
    taken = [frame["f_drain[5]"].sum() for _, frame in spots]
    assert log[MOVES][:20] == pytest.approx(taken[:20])


def test_sweeps_of_the_schedules(tmp_path):
    """In the order of time a relaxation follows a move, or comes at its time."""
    sweeps, moves = {}, {}
    for how in ["every 1", "every 3", "spot 3", "chance 3", "global 2", "never"]:
        log = thermo(run_ok(deck(fix=f"{FIX} accuracy exact relax {how}", run="run 10"), tmp_path))
        sweeps[how], moves[how] = log[SWEEPS][-1], log[MOVES][-1]
    assert len(set(moves.values())) == 1  # none is out at the top yet
    total = sweeps["every 1"]
    assert 0 < total <= moves["every 1"]
    assert sweeps["every 3"] == pytest.approx(total / 3, rel=0.05)
    assert sweeps["spot 3"] == pytest.approx(total / 3, rel=0.15)
    assert abs(sweeps["chance 3"] - total / 3) < 5 * np.sqrt(total * 2 / 9)
    assert abs(sweeps["global 2"] - 1 / (2 * 0.1 / 3.2)) <= 1
    assert sweeps["never"] == 0


def test_spots_in_dump_local(drained):
    log, _, spots = drained
    assert len(spots) == 31
    for k, (_, frame) in enumerate(spots):
        assert list(frame) == [f"f_drain[{c}]" for c in range(1, 7)]
        identity, x, y, z, steps, volume = frame.values()
        assert len(identity) == log[SPOTS][k]
        assert (np.diff(identity) > 0).all()
        assert (volume == 1).all() and log[LEFT][k] == 0
        assert (steps == steps.round()).all() and (steps >= 0).all()
        assert (abs(x) <= HALF_WIDTH - 0.25 + 1e-9).all() and (abs(y) <= HALF_DEPTH - 0.25 + 1e-9).all()
        assert z == pytest.approx(-3.53 + 0.4 * steps)  # births R_s below the orifice, steps of 0.4 d
    # Poisson: 100 births a time; the last spot ever born has the largest id.
    born = spots[-1][1]["f_drain[1]"].max() + 1
    assert abs(born - 300) < 5 * np.sqrt(300)


@pytest.mark.parametrize("accuracy", ["normal", "exact"])
def test_volume_that_spots_have_left(tmp_path, accuracy):
    """Grains' worth of it: w N for each newborn spot's volume that live ones lack. Removed spots take theirs with them."""
    fix = f"{FIX} accuracy {accuracy} profile uniform radius 2.5 volume 72 critical 0.52 1 dilatancy 0.1 dz 0.4"
    after = f"dump_modify grains every 1\nthermo 1\n{DUMP_SPOTS}\ndump_modify spots format float %.12g"
    log = thermo(run_ok(deck(fix=fix, run="run 40", after=after), tmp_path))
    compared = 0
    for k, (_, frame) in enumerate(read_dump(tmp_path / "spots.dump")):
        assert (frame["f_drain[6]"] >= 0.1).all() and (frame["f_drain[6]"] <= 4).all()
        if frame["f_drain[5]"].sum() != log[MOVES][k]:  # a spot is out at the top
            continue
        assert log[LEFT][k] == pytest.approx(0.01 * 72 * (1 - frame["f_drain[6]"]).sum(), rel=1e-9, abs=1e-9)
        compared += log[LEFT][k] != 0
    assert compared > 5


def test_no_grain_outside_and_none_too_deep(drained):
    _, frames, _ = drained
    for _, frame in frames:
        x = positions(frame)
        assert (abs(x[:, 0]) <= HALF_WIDTH - 0.45).all() and (abs(x[:, 1]) <= HALF_DEPTH - 0.45).all()
        below = x[:, 2] < 0
        assert (np.hypot(x[below, 0], x[below, 1]) < 3.1).all()


def test_velocity_is_displacement_over_the_step(drained):
    _, frames, _ = drained
    for (_, before), (_, after) in zip(frames[10:], frames[11:]):
        stays = np.isin(before["id"], after["id"])
        moved = positions(after) - positions(before)[stays]
        velocity = np.stack([after[f"v{axis}"] for axis in "xyz"], axis=1)
        assert velocity == pytest.approx(moved / 0.1, abs=1e-9)


def test_mass_of_unequal_grains(tmp_path):
    """The drained mass is that of the grains that left, whatever each weighs."""
    heavy = "set atom 1*300 density 10"
    screen = run_ok(deck(before=heavy), tmp_path)
    log, frames = thermo(screen), read_dump(tmp_path / "grains.dump")
    gone = np.setdiff1d(frames[0][1]["id"], frames[-1][1]["id"])
    assert 0 < (gone <= 300).sum() < len(gone)
    assert log[MASS][-1] == pytest.approx(np.where(gone <= 300, 10, 1).sum() * np.pi / 6)


@programs
def test_thermo_keeps_watch_for_lost_grains(tmp_path, program):
    """Drained grains are not lost ones, not even to `thermo_modify lost error`, at any interval of thermo."""
    screen = run_ok(deck(after="thermo 1", run="run 30"), tmp_path, program=program)
    assert "ost atoms" not in screen
    assert thermo(screen)["Atoms"][-1] < len(lattice())


def test_a_silo_that_runs_empty(tmp_path):
    """Drained to the last grain; a run more changes nothing and is no error."""
    few = [(0.0, 0.0, 0.6), (1.1, 0.0, 0.6), (0.0, 1.1, 0.6)]
    write_data(tmp_path / "packing.data", few)
    fix = FIX.replace("influence 1e-2", "influence 0.1").replace("injection 100", "injection 30")
    screen = run_ok(deck(fix=fix, run="run 60\nrun 5"), tmp_path)
    log = thermo(screen)
    assert log["Atoms"][-1] == 0
    assert log[DRAINED][-1] == 3


def test_grains_outside_the_group_are_held(tmp_path):
    """They do not move by a bit, and the others give way to them."""
    held = "region few block -2 2 -2 2 2 4\ngroup held region few\ngroup loose subtract all held"
    run_ok(deck(before=held, fix=FIX.replace("all", "loose", 1), run="run 30"), tmp_path)
    frames = read_dump(tmp_path / "grains.dump")
    start, end = frames[0][1], frames[-1][1]
    x = positions(start)
    fixed = (abs(x[:, 0]) <= 2) & (abs(x[:, 1]) <= 2) & (x[:, 2] >= 2) & (x[:, 2] <= 4)
    assert 10 < fixed.sum() < 100
    kept = np.isin(start["id"][fixed], end["id"])
    assert kept.all()
    assert (positions(end)[np.isin(end["id"], start["id"][fixed])] == x[fixed]).all()
    assert len(end["id"]) < len(start["id"])


def test_values_between_runs(tmp_path):
    """The vector can be asked for between runs, even when the region that held the grains is gone."""
    fix = FIX.replace("box -5.0 5.0 -4.0 4.0", "region silo")
    screen = run_ok(deck(before="region silo block -5 5 -4 4 0 20 open 5", fix=fix,
                         run='run 20\nregion silo delete\nprint "overlap $(f_drain[6]:%.15g)"'), tmp_path)
    said = [float(line.split()[1]) for line in screen.splitlines() if line.startswith("overlap")]
    assert said == [pytest.approx(thermo(screen)[OVERLAP][-1])]


def megabytes(folder, fix):
    """What the program holds after a step of the silo of 2006, and what LAMMPS says that it is."""
    screen = run_ok(f"""
units lj
atom_style sphere
boundary f f f
include {LOAD_SPOT}
read_data {ROOT}/examples/silo/packing.data.gz
{fix}
timestep 1e-3
run 1
info memory
""", folder)
    held = re.search(r"Total dynamically allocated memory: ([\d.]+) Mbyte", screen)
    said = re.search(r"Per MPI rank memory allocation \(min/avg/max\) = ([\d.]+)", screen)
    return float(held[1]), float(said[1])


@pytest.mark.parametrize("words", ["", "peratom yes", "accuracy exact"])
def test_memory_usage(tmp_path, words):
    """To 10 per cent, and LAMMPS counts all that it holds itself."""
    silo = "box -0.075 0.075 -0.012 0.012 orifice 0 0 0 0.012 speed 0.549 injection 22185"
    without = megabytes(tmp_path, "fix nothing all nve/sphere")
    held, said = (a - b for a, b in zip(megabytes(tmp_path, f"fix drain all spot {silo} {words}"), without))
    assert held > 5
    assert said == pytest.approx(held, rel=0.1)


def scene(folder, name="scene.json"):
    return json.loads((folder / name).read_text())


@needs_mpirun
def test_the_scene_is_that_of_the_analysis(tmp_path):
    """On ranks, too; the second run has fewer grains, but the scene is that of the start."""
    run_ok(deck(fix=FIX + " scene scene.json 9.75", run="run 30\nrun 10"), tmp_path, launcher=on_ranks(2))
    assert scene(tmp_path)["format"] == 1
    found = load_scene(str(tmp_path))
    assert (found.diameter, found.gravity, found.timestep) == (1, 9.75, 0.1)
    assert (found.half_width_x, found.half_depth_y, found.orifice_radius) == (HALF_WIDTH, HALF_DEPTH, ORIFICE)
    assert found.grains == len(lattice()) and found.opening_time == 0


def test_the_scene_counts_time_from_the_first_step_of_the_fix(tmp_path):
    run_ok(deck(before="reset_timestep 50", fix=FIX + " scene scene.json 1", run="run 10\nwrite_restart saved"), tmp_path)
    assert scene(tmp_path)["opening_time"] == pytest.approx(5)
    (tmp_path / "scene.json").unlink()
    run_ok(f"units lj\natom_style sphere\nboundary f f f\ninclude {LOAD_SPOT}\nread_restart saved\ntimestep 0.1\n"
           f"{FIX} scene again.json 1\nrun 10\n", tmp_path)
    assert not (tmp_path / "scene.json").exists()
    again = scene(tmp_path, "again.json")
    assert again["opening_time"] == pytest.approx(5) and again["grains"] == len(lattice())


def test_a_scene_that_cannot_be_written_is_named(tmp_path):
    said = error_of(deck(fix=FIX + " scene nowhere/scene.json 1"), tmp_path)
    assert "'scene' cannot write nowhere/scene.json: its folder must be there" in said
