# SPDX-License-Identifier: GPL-2.0-or-later
"""Rates of outlets that follow a LAMMPS variable, held against tables of the same factors."""

import numpy as np
import pytest

from lammps_runs import FIX, deck, drain, error_of, lattice, needs_mpirun, on_ranks, read_dump, run_ok, thermo, write_data
from test_outlets import TWO, write_wide

ROUND = "walls add block -5 5 -4 4 0 30 orifice -2.4 0 0 2.2 orifice 2.4 0 0 2.2"
OPEN = 'variable gate equal "step >= 10 && step < 40"'
TABLE = "schedule 2 0 0 1 1 4 0"


def fix(schedule, rates="injection 150 150", more="window 0.1"):
    return f"fix drain all spot {ROUND} influence 1e-2 speed 3.2 {rates} radius 2.2 volume 20 seed 1 {schedule} {more}"


def last(folder):
    return read_dump(folder / "grains.dump")[-1][1]


def test_one_all_the_time_is_no_schedule(tmp_path):
    constant = drain(tmp_path / "variable", fix=FIX + " schedule 1 v_one", before="variable one equal 1")
    assert constant == drain(tmp_path / "none")


@needs_mpirun
@pytest.mark.parametrize("rates", ["injection 150 150", "outflow 30 30"])
def test_steps_are_those_of_a_table(tmp_path, rates):
    """On ranks and threads, and from a restart file in the middle."""
    table = drain(tmp_path / "table", fix=fix(TABLE, rates), run="run 60")
    follow = dict(fix=fix("schedule 2 v_gate", rates), before=OPEN)
    assert drain(tmp_path / "one", run="run 60", **follow) == table
    (tmp_path / "parts").mkdir()
    run_ok(deck(run="run 8\nrun 6\nwrite_restart part.restart", **follow), tmp_path / "parts", launcher=on_ranks(2))
    follow["fix"] += " threads 2"
    rest = deck(run="run 46", **follow).replace("read_data packing.data", "read_restart part.restart")
    run_ok(rest, tmp_path / "parts")
    whole, parts = last(tmp_path / "table"), last(tmp_path / "parts")
    assert len(whole["id"]) < len(lattice()) - 20
    assert all((whole[column] == parts[column]).all() for column in whole)


def test_steps_are_those_of_a_table_in_the_order_of_time(tmp_path):
    exact = dict(run="run 12", timestep=0.05)
    table = drain(tmp_path / "table", fix=fix("schedule 2 0 0 0.2 1", more="accuracy exact dz 0.4"), **exact)
    follow = fix("schedule 2 v_gate", more="accuracy exact dz 0.4")
    assert drain(tmp_path / "variable", fix=follow, before='variable gate equal "time > 0.19"', **exact) == table


def test_outlets_close_and_open_by_what_has_drained(tmp_path):
    """The first is closed after 20 grains, and the second opened."""
    write_wide(tmp_path)
    before = 'variable first equal "f_drain[9] < 20"\nvariable second equal 1-v_first'
    command = f"fix drain all spot {TWO} influence 1e-2 speed 3.2 injection 90 90 schedule 1 v_first schedule 2 v_second"
    out = thermo(run_ok(deck(command, "run 120", before), tmp_path))
    first, second = out["f_drain[9]"], out["f_drain[10]"]
    assert (second[first < 20] <= 1).all(), "closed"
    assert 20 <= first[-1] < 120, "spots that were there climb on, for R_s / v_s at 63 grains a unit of time"
    assert first[-1] <= first[out["Step"] == 80][0] + 5, "closed for good"
    assert second[-1] > 20


def test_a_restart_file_knows_the_variable(tmp_path):
    before = "variable gate equal 0.5\nvariable other equal 0.5"
    run_ok(deck(fix("schedule 2 v_gate"), run="run 10\nwrite_restart half.restart", before=before), tmp_path)
    rest = deck(fix("schedule 2 v_other"), run="run 10", before=before)
    error = error_of(rest.replace("read_data packing.data", "read_restart half.restart"), tmp_path)
    assert "injection was 150 150; schedule 2 v_gate" in error and "is 150 150; schedule 2 v_other now" in error


@pytest.mark.parametrize("variable, said", [
    ("", ["variable 'gate'", "'schedule 1 v_gate'", "does not exist", "variable gate equal"]),
    ("variable gate atom x", ["variable 'gate'", "is not equal-style"]),
    ("variable gate index 1 2", ["variable 'gate'", "is not equal-style"]),
    ("variable gate equal -(step>=3)", ["variable 'gate'", "outlet 1, is -1 at step 3", "must be finite, and 0 or more"]),
    ("variable gate equal exp(1000)", ["variable 'gate'", "is inf at step 0", "must be finite, and 0 or more"]),
    ("variable gate equal 1+1e5*(step>1)", ["variable 'gate'", "is 100001 at step 2", "it must be at most 3.4", "simulation box"])])
def test_values_that_do_not_fit_are_named(tmp_path, variable, said):
    error = error_of(deck(FIX + " schedule 1 v_gate", before=variable), tmp_path)
    assert all(part in error for part in said), error


def test_values_that_are_too_much_for_the_window_are_named(tmp_path):
    error = error_of(deck(FIX + " window 0.2 schedule 1 v_gate", before="variable gate equal 1+2*(step>1)", timestep=0.2), tmp_path)
    assert "is 3 at step 2" in error and "shorten the window" in error, error


@needs_mpirun
def test_values_that_do_not_fit_end_all_ranks(tmp_path):
    write_data(tmp_path / "packing.data", lattice())
    error = error_of(deck(FIX + " schedule 1 v_gate", before="variable gate equal 2-step"), tmp_path, launcher=on_ranks(2))
    assert "is -1 at step 3" in error


def test_closed_all_the_time_nothing_moves(tmp_path):
    out = thermo(run_ok(deck(FIX + " schedule 1 v_gate", before="variable gate equal 0"), tmp_path))
    assert (out["f_drain[1]"] == 0).all() and (out["f_drain[3]"] == 0).all()
    frames = read_dump(tmp_path / "grains.dump")
    assert all(np.array_equal(frames[0][1]["z"], frame["z"]) for _, frame in frames)
