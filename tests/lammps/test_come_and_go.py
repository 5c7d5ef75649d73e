# SPDX-License-Identifier: GPL-2.0-or-later
"""Grains that other commands and fixes add, take, move, rename or change, between runs and in them; and who else may not."""

import re

import numpy as np
import pytest

from lammps_runs import (BOX, FIX, HEIGHT, LOAD_SPOT, deck, drain, error_of, lattice, needs_mpirun, on_ranks, positions, read_dump,
                         run_ok, run_text, thermo, write_data)

FIX = FIX + " volume 77"
TOP = "region top block -4 4 -3 3 13 18"
# One grain every two steps; they take part from the step after.
DEPOSIT = TOP + "\nfix dep all deposit 40 1 2 4711 region top near 1.0"
GROWTH = "set group all diameter 1.0\nset group all density 1.0"


def last(folder, name="grains.dump"):
    return read_dump(folder / name)[-1][1]


def hanging(frame, new):
    """Of some grains, those with nothing lower than themselves within 1.1 d, nor the base."""
    at = positions(frame)
    alone = []
    for k in np.flatnonzero(new):
        lower = (at[:, 2] < at[k, 2]) & (((at - at[k]) ** 2).sum(axis=1) < 1.1 ** 2)
        if not lower.any() and at[k, 2] > 0.6:
            alone.append(int(frame["id"][k]))
    return alone


def counts_close(said, added):
    columns = thermo(said)
    assert columns["Atoms"][-1] + columns["f_drain[3]"][-1] == len(lattice()) + added


def test_deposited_grains_take_part_in_the_next_step(tmp_path):
    said = run_ok(deck(fix=FIX, run="run 79", after=DEPOSIT + "\ndump_modify grains every 1"), tmp_path)
    counts_close(said, 40)
    for step, frame in read_dump(tmp_path / "grains.dump"):
        new = frame["id"] == len(lattice()) + step // 2  # came at the end of the step before this one, if that was even
        assert step % 2 == 0 or not hanging(frame, new), step
    assert len(set(last(tmp_path)["id"]) - set(range(1, len(lattice()) + 1))) > 30


@needs_mpirun
@pytest.mark.parametrize("ranks", [2, 3])
def test_deposit_on_ranks(tmp_path, ranks):
    one = drain(tmp_path / "one", fix=FIX, run="run 60", after=DEPOSIT)
    assert drain(tmp_path / "more", fix=FIX, run="run 60", after=DEPOSIT, launcher=on_ranks(ranks)) == one


@pytest.mark.parametrize("ranks", [1, pytest.param(3, marks=needs_mpirun)])
def test_deposit_over_a_restart(tmp_path, ranks):
    """The last snapshot of a run that is interrupted, and goes on, on other ranks."""
    drain(tmp_path / "whole", fix=FIX, run="run 60", after=DEPOSIT)
    (tmp_path / "parts").mkdir()
    run_ok(deck(fix=FIX, run="run 30\nwrite_restart half", after=DEPOSIT), tmp_path / "parts")
    rest = f"units lj\natom_style sphere\ninclude {LOAD_SPOT}\nread_restart half\n"
    rest += run_text(FIX, "run 60 upto", after=DEPOSIT, dumps="rest.dump")
    run_ok(rest, tmp_path / "parts", launcher=on_ranks(ranks) if ranks > 1 else ())
    whole, parts = last(tmp_path / "whole"), last(tmp_path / "parts", "rest.dump")
    for column in "id", "x", "y", "z":
        assert (whole[column] == parts[column]).all(), column


def test_pour(tmp_path):
    pour = (TOP.replace("block -4 4 -3 3 13 18", "block -4 4 -3 3 12 18") +
            "\nfix g all gravity 1.0 vector 0 0 -1\nfix p all pour 60 1 4767548 vol 0.2 100 region top")
    said = run_ok(deck(fix=FIX, run="run 80", after=pour), tmp_path)
    counts_close(said, 60)
    frame = last(tmp_path)
    assert not hanging(frame, frame["id"] > len(lattice()))
    assert "fix spot needs no forces; unused, but for their time: fix g (gravity)" in said


CREATE = f"lattice sc 0.8\nregion top block -4 4 -3 3 15 18\ncreate_atoms 1 region top\n{GROWTH}"
CHANGES = {"create_atoms": CREATE,
           "displace_atoms": "region low block -5 5 -4 4 3 5\ngroup low region low\ndisplace_atoms low move 0 0 14.0",
           "delete_atoms": "region band block -5 5 -4 4 4 7\ndelete_atoms region band compress no",
           "set": "variable up atom 15.0+1.2*(id-400)\ngroup some id 400:420\nset group some z v_up x 0.1 y 0.2",
           "reset_atom_ids": "reset_atom_ids sort yes"}


def changed(folder, change, launcher=()):
    """Screen output and snapshots, by step, of a run in which this is done after step 20."""
    folder.mkdir()
    write_data(folder / "packing.data", lattice(), box=BOX[:5] + (60.0,))
    text = deck(fix=FIX, run=f"run 20\n{change}\nrun 1\nrun 29", after="dump_modify grains every 1")
    return run_ok(text, folder, launcher=launcher), dict(read_dump(folder / "grains.dump"))


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_between_runs(tmp_path, change):
    """All that was changed comes down onto the bed before the spots go on."""
    said, frames = changed(tmp_path / "one", change)
    columns = thermo(said)
    at_change = list(columns["Step"]).index(20)
    here = columns["Atoms"] + columns["f_drain[3]"]
    assert set(here[:at_change]) == {len(lattice())} and len(set(here[at_change + 2:])) == 1
    before = dict(zip(frames[20]["id"], frames[20]["z"]))
    moved = np.array([abs(before.get(grain, -99.0) - z) > 0.5 for grain, z in zip(frames[21]["id"], frames[21]["z"])])
    if change != CHANGES["reset_atom_ids"]:
        assert moved.sum() >= 15 and len(hanging(frames[21], moved)) <= 0.01 * moved.sum()
    assert frames[50]["z"].max() < HEIGHT + 7.0


@needs_mpirun
@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_between_runs_on_ranks(tmp_path, change):
    changed(tmp_path / "one", change)
    changed(tmp_path / "three", change, launcher=on_ranks(3))
    assert (tmp_path / "three" / "grains.dump").read_bytes() == (tmp_path / "one" / "grains.dump").read_bytes()


def test_other_ids_change_no_position(tmp_path):
    _, kept = changed(tmp_path / "kept", "")
    _, renamed = changed(tmp_path / "renamed", "reset_atom_ids sort yes")
    assert sorted(map(tuple, positions(renamed[50]))) == sorted(map(tuple, positions(kept[50])))
    assert renamed[50]["id"].max() < kept[50]["id"].max()


def test_another_group_holds_grains(tmp_path):
    """Those that leave the group in which the fix moves grains are obstacles from then on."""
    fix = FIX.replace("drain all", "drain beads")
    text = deck(fix=fix, before="group beads id > 0", after="dump_modify grains every 1",
                run="run 20\ngroup hold id 100:104\ngroup rest subtract all hold\ngroup beads clear\n"
                    "group beads union rest rest\nrun 30")
    run_ok(text, tmp_path)
    frames = dict(read_dump(tmp_path / "grains.dump"))
    held = [np.isin(frames[step]["id"], range(100, 105)) for step in (20, 50)]
    assert held[1].sum() == held[0].sum() == 5
    assert (positions(frames[20])[held[0]] == positions(frames[50])[held[1]]).all()


@pytest.mark.parametrize("ranks", [1, pytest.param(3, marks=needs_mpirun)])
def test_evaporate(tmp_path, ranks):
    """What another fix takes is gone, and not what left: thermo_modify lost error holds."""
    evaporate = "region some block -5 5 -4 4 -4 9\nfix less all evaporate 3 2 some 4711"
    said = run_ok(deck(fix=FIX, run="run 60", after=evaporate), tmp_path, launcher=on_ranks(ranks) if ranks > 1 else ())
    columns = thermo(said)
    assert columns["f_drain[3]"][-1] > 20
    taken = len(lattice()) - columns["Atoms"] - columns["f_drain[3]"]
    assert 30 <= taken[-1] <= 2 * 20 and (np.diff(taken) >= 0).all()


def test_refilling_keeps_going(tmp_path):
    """As much comes as leaves, 20 tau long: nothing hangs, and the bed keeps its height."""
    refill = TOP + "\nfix dep all deposit 700 1 1 4711 region top near 1.0 attempt 50"
    said = run_ok(deck(fix=FIX.replace("injection 100", "injection 33"), run="run 700", timestep=0.03, after=refill), tmp_path)
    counts_close(said, 700)
    frame = last(tmp_path)
    new = frame["id"] > len(lattice())
    assert new.sum() > 300
    # The last one came after the last step of the spots; flow leaves few others without a neighbour below.
    assert len(hanging(frame, new)) <= 0.02 * new.sum() + 1


# ---- what cannot be

def put(x, y, z):
    return f"create_atoms 1 single {x} {y} {z}\n{GROWTH}"


@pytest.mark.parametrize("change, said", [
    ("region mid block -4 4 -3 3 3 8\ncreate_atoms 1 random 50 4711 mid\n" + GROWTH, ["overlap by 0.", "when they are put in", "at most 0.03"]),
    ("group some id 300\ndisplace_atoms some move 0.3 0 0", ["grains ", " and ", "overlap by", "at most 0.03"]),
    (put(0, 0, 15) + "\n" + put(0.4, 0, 15), ["overlap by 0.6", "when they are put in"]),
    ("group some id 300\ndisplace_atoms some move 0 0 -12", ["grain 300 at (", "is outside the container"]),
], ids=["random", "displaced", "one in another", "outside"])
@pytest.mark.parametrize("when", ["before the first run", "between runs"])
def test_refused(tmp_path, change, said, when):
    first = "run 5\n" if when == "between runs" else ""
    error = error_of(deck(fix=FIX, run=f"{first}{change}\nrun 5"), tmp_path)
    if when == "before the first run":
        said = [words.replace("when they are put in", "at the start") for words in said]
    if "is outside the container" in said and when == "between runs":
        said = said[-1:]
    for words in said:
        assert words in error, error


def test_adapted_diameter_is_seen_in_the_next_step(tmp_path):
    adapt = "variable wide equal ramp(1.0,1.2)\nfix grow all adapt 10 atom diameter v_wide"
    text = deck(fix=FIX, run="run 40", after=adapt).replace("atom_style sphere", "atom_style sphere 1")
    error = error_of(text, tmp_path)
    assert "diameters from 0.5 to 1, the largest at the start" in error and "has 1.05" in error, error


def test_adapted_diameter_that_may_come_may_not_change(tmp_path):
    adapt = "variable wide equal ramp(1.0,0.8)\nfix shrink all adapt 10 atom diameter v_wide"
    text = deck(fix=FIX, run="run 40", after=adapt).replace("atom_style sphere", "atom_style sphere 1")
    error = error_of(text, tmp_path)
    assert " was 1 wide and is 0.95 wide now: grains must keep their size" in error, error


def test_diameter_that_shrinks(tmp_path):
    error = error_of(deck(fix=FIX, run="run 5\nset atom 300 diameter 0.9\nrun 5"), tmp_path)
    assert "grain 300 was 1 wide and is 0.9 wide now: grains must keep their size" in error, error


@pytest.mark.parametrize("integrator, said", [
    ("fix move all nve/sphere", "fix move (nve/sphere) moves"),
    ("group some id 1:50\nfix move some nve", "fix move (nve) moves 50 of the grains that fix drain (spot) moves"),
    ("fix move all nve/limit 0.1", "leave it out, or 'unfix move'"),
])
def test_no_other_integrator(tmp_path, integrator, said):
    error = error_of(deck(fix=FIX, before=integrator, run="run 1"), tmp_path)
    assert said in error, error


def test_integrator_of_held_grains(tmp_path):
    """Others may move what the fix does not."""
    before = "group held id 1:20\ngroup beads subtract all held\nfix still held nve/noforce"
    run_ok(deck(fix=FIX.replace("drain all", "drain beads"), before=before, run="run 5"), tmp_path)


def test_unused_forces_are_named(tmp_path):
    before = ("pair_style gran/hooke/history 1000.0 NULL 50.0 NULL 0.5 0\npair_coeff * *\ncomm_modify vel yes\n"
              "fix g all gravity 1.0 vector 0 0 -1\nfix base all wall/gran hooke/history 1000.0 NULL 50.0 NULL 0.5 0 zplane -3.9 NULL")
    said = run_ok(deck(fix=FIX, before=before, run="run 2\nrun 2"), tmp_path)
    named = re.findall("fix spot needs no forces.*", said)
    assert len(named) == 1, said
    for words in "pair style gran/hooke/history", "fix g (gravity)", "fix base (wall/gran)":
        assert words in named[0], named


# ---- the clock

def test_run_0_before_the_final_timestep(tmp_path):
    """Nothing follows from a timestep in which nothing was done."""
    plain = drain(tmp_path / "plain", fix=FIX)
    text = deck(fix=FIX).replace("timestep 0.1", "timestep 1e-6\nrun 0\ntimestep 0.1")
    (tmp_path / "late").mkdir()
    run_ok(text, tmp_path / "late")
    assert (tmp_path / "late" / "grains.dump").read_bytes() == plain


def test_restart_after_run_0(tmp_path):
    drain(tmp_path / "plain", fix=FIX)
    run_ok(deck(fix=FIX, run="run 0\nwrite_restart start", timestep=1e-6), tmp_path)
    rest = f"units lj\natom_style sphere\ninclude {LOAD_SPOT}\nread_restart start\n" + run_text(FIX, "run 30")
    run_ok(rest, tmp_path)
    plain, late = last(tmp_path / "plain"), last(tmp_path)
    assert (positions(plain) == positions(late)).all()


def test_outflow_over_a_change_of_the_timestep(tmp_path):
    """A mean over time, whatever the steps were."""
    said = run_ok(deck(fix=FIX + " window 0.05", run="run 40\ntimestep 0.2\nrun 10\ntimestep 0.05\nrun 20"), tmp_path)
    columns = thermo(said)
    assert columns["f_drain[5]"][-1] == pytest.approx(columns["f_drain[3]"][-1] / (40 * 0.1 + 10 * 0.2 + 20 * 0.05))


def test_another_timestep_changes_nothing(tmp_path):
    drain(tmp_path / "one", fix=FIX + " window 0.05", run="run 30")
    drain(tmp_path / "other", fix=FIX + " window 0.05", run="run 10\ntimestep 0.05\nrun 20\ntimestep 0.1\nrun 10")
    (_, one), (_, other) = read_dump(tmp_path / "one" / "grains.dump")[-1], read_dump(tmp_path / "other" / "grains.dump")[-1]
    assert one["id"].tolist() == other["id"].tolist() and positions(one).tolist() == positions(other).tolist()


def test_a_timestep_that_does_not_fit_is_explained(tmp_path):
    error = error_of(deck(fix=FIX, run="run 10\ntimestep 0.13\nrun 10"), tmp_path)
    assert "timestep 0.13 must be a whole number of windows" in error and "since the first run" in error, error
