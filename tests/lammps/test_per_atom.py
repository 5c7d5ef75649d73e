# SPDX-License-Identifier: GPL-2.0-or-later
"""What has become of each grain: its displacement, and the moves that it has received."""

import struct

import numpy as np
import pytest

from lammps_runs import (FIX, LOAD_SPOT, deck, error_of, lammps_version, needs_mpirun, on_ranks, positions, programs, read_dump,
                         run_ok, run_text, thermo)

PER_ATOM = FIX + " volume 77 peratom yes"
DUMP = """dump fates all custom 10 fates.dump id x y z f_drain[1] f_drain[2] f_drain[3] f_drain[4]
dump_modify fates sort id format float %.17g"""


def fates(folder, fix=PER_ATOM, dump=DUMP, **parts):
    """The dump, as bytes, and its frames."""
    folder.mkdir(exist_ok=True)
    launcher = parts.pop("launcher", ())
    run_ok(deck(fix=fix, after=dump, **parts), folder, launcher=launcher)
    return (folder / "fates.dump").read_bytes(), [frame for _, frame in read_dump(folder / "fates.dump")]


def displacements(frame):
    return np.stack([frame[f"f_drain[{column}]"] for column in (1, 2, 3)], axis=1)


def moves(frame):
    return frame["f_drain[4]"]


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    return fates(tmp_path_factory.mktemp("alone"))


@pytest.mark.parametrize("accuracy", ["normal", "exact"])
def test_displacement_is_position_less_start(tmp_path, accuracy):
    held = "region few block -2 2 -2 2 2 4\ngroup held region few\ngroup loose subtract all held"
    fix = PER_ATOM.replace("all", "loose", 1) + f" accuracy {accuracy}"
    _, frames = fates(tmp_path, fix=fix, before=held, run="run 10\nrun 10")
    start, end = frames[0], frames[-1]
    assert not displacements(start).any() and not moves(start).any()
    left = np.isin(start["id"], end["id"])
    assert 0 < left.sum() < len(left)
    assert (displacements(end) == positions(end) - positions(start)[left]).all()
    x, y, z = positions(start)[left].T
    fixed = (abs(x) <= 2) & (abs(y) <= 2) & (z >= 2) & (z <= 4)
    assert fixed.any() and not moves(end)[fixed].any() and not displacements(end)[fixed].any()
    assert moves(end).max() > 50 and (moves(end) == moves(end).round()).all()


def test_moves_without_relaxation(tmp_path):
    """Each takes a grain down by w dz, to the quantum."""
    _, frames = fates(tmp_path, fix=FIX + " peratom yes relax never dz 0.4 profile uniform", run="run 20")
    end = frames[-1]
    assert -displacements(end)[:, 2] == pytest.approx(moves(end) * 1e-2 * 0.4, abs=1e-9)
    assert moves(end).max() > 50


def test_off_by_default(tmp_path):
    """Then there is no array; and counting moves no grain."""
    error = error_of(deck(fix=FIX, after=DUMP), tmp_path)
    assert "does not compute per-atom" in error
    run_ok(deck(fix=FIX), tmp_path)
    without = (tmp_path / "grains.dump").read_bytes()
    run_ok(deck(fix=FIX + " peratom yes"), tmp_path)
    assert (tmp_path / "grains.dump").read_bytes() == without


@programs
def test_array_reaches_variables_and_computes(alone, tmp_path, program):
    # Not in 2021, but in 2025 a lower-case name means the column in atom-style variables.
    column = "f_drain[3]" if lammps_version(program).year >= 2025 else "F_drain[3]"
    after = f"variable fallen atom -{column}\ncompute most all reduce max f_drain[4] v_fallen\n" \
            "thermo_style custom step atoms c_most[1] c_most[2]"
    log = thermo(run_ok(deck(fix=PER_ATOM, after=after), tmp_path, program=program))
    assert log["c_most[1]"][-1] == moves(alone[1][-1]).max()
    assert log["c_most[2]"][-1] == pytest.approx(-displacements(alone[1][-1])[:, 2].min())


def test_threads_and_sorting(alone, tmp_path):
    assert fates(tmp_path, fix=PER_ATOM + " threads 3", before="atom_modify sort 2 2.0")[0] == alone[0]


@needs_mpirun
@pytest.mark.parametrize("ranks, before", [(2, ""), (3, "fix even all balance 5 1.0 shift z 10 1.05"), (4, "")])
def test_ranks(alone, tmp_path, ranks, before):
    """Grains go from rank to rank, in LAMMPS and in the fix."""
    assert fates(tmp_path, before=before, launcher=on_ranks(ranks))[0] == alone[0]


def rest_of(fix, steps=30):
    return f"units lj\natom_style sphere\ninclude {LOAD_SPOT}\nread_restart half.restart\n" + run_text(
        fix, f"run {steps} upto", after=DUMP)


@needs_mpirun
@pytest.mark.parametrize("before, after", [(1, 1), (1, 3), (2, 1)])
def test_restart(alone, tmp_path, before, after):
    run_ok(deck(fix=PER_ATOM, run="run 10\nwrite_restart half.restart"), tmp_path, launcher=on_ranks(before))
    run_ok(rest_of(PER_ATOM), tmp_path, launcher=on_ranks(after))
    assert last_frame(tmp_path) == alone[0].split(b"ITEM: TIMESTEP")[-1]


def last_frame(folder):
    return (folder / "fates.dump").read_bytes().split(b"ITEM: TIMESTEP")[-1]


def test_damaged_restart(tmp_path):
    """One bit of a displacement, or of the number of values, which counts itself and the checksum."""
    dump = DUMP.replace("custom 10", "custom 5")
    _, frames = fates(tmp_path, dump=dump, run="run 5\nwrite_restart half.restart")
    data = (tmp_path / "half.restart").read_bytes()
    fallen = frames[-1]["f_drain[3]"].min()
    at = data.index(struct.pack("<d", fallen))
    assert struct.unpack_from("<d", data, at - 24)[0] == 7.0 and fallen < -0.1
    for place in (at, at + 7, at - 24 + 6, at - 24 + 7, at + 24):
        damaged = bytearray(data)
        damaged[place] ^= 0x10
        (tmp_path / "half.restart").write_bytes(damaged)
        assert "damaged: what it has of grain" in error_of(rest_of(PER_ATOM, 10), tmp_path), place - at


def test_restart_that_switches_it_on_or_off(alone, tmp_path):
    """On, it counts from then; off, the run goes on."""
    run_ok(deck(fix=PER_ATOM.replace("peratom yes", ""), run="run 20\nwrite_restart half.restart"), tmp_path)
    run_ok(rest_of(PER_ATOM), tmp_path)
    whole, rest = alone[1], [frame for _, frame in read_dump(tmp_path / "fates.dump")][-1]
    kept = np.isin(whole[2]["id"], rest["id"])
    assert (moves(rest) == moves(whole[3]) - moves(whole[2])[kept]).all()
    assert (displacements(rest) == displacements(whole[3]) - displacements(whole[2])[kept]).all()
    run_ok(deck(fix=PER_ATOM, run="run 20\nwrite_restart half.restart"), tmp_path)
    run_ok(rest_of(PER_ATOM.replace("peratom yes", "")).replace(DUMP, ""), tmp_path)


def test_grains_that_others_move_or_add(tmp_path):
    """What others do to a grain is not counted; what is added begins at zero."""
    run = "run 10\ngroup top id 900:999\ndisplace_atoms top move 0 0 3\n" \
          "create_atoms 1 single 0 0 16\nset type 1 diameter 1 density 1\nrun 10"
    _, frames = fates(tmp_path, run=run)
    before, after = frames[0], frames[-1]
    moved = np.isin(after["id"], np.arange(900, 1000))
    shift = positions(after)[moved] - positions(before)[np.isin(before["id"], after["id"][moved])]
    assert displacements(after)[moved] == pytest.approx(shift - (0, 0, 3), abs=1e-6)
    added = after["id"] == before["id"].max() + 1
    assert added.sum() == 1 and abs(displacements(after)[added]).max() < 1
