# SPDX-License-Identifier: GPL-2.0-or-later
"""A silo that is refilled as fast as it drains, for 200 tau: three times as many grains as are in it go through."""

import numpy as np
import pytest

from lammps_runs import FIX, LOAD_SPOT, deck, lattice, needs_mpirun, on_ranks, positions, read_dump, run_ok, run_text, thermo
from test_come_and_go import hanging

FIX = FIX.replace("injection 100", "injection 12") + " volume 77"
TIMESTEP, STEPS = 0.1, 2000
# A grain a step, as many as leave: nu_s w N = 12 * 0.01 * 77 = 9.2 a tau.
REFILL = "region top block -4.4 4.4 -3.4 3.4 13 18\nfix dep all deposit 100000 1 1 4711 region top near 1.0 attempt 50"
WHOLE = f"run {STEPS}"


def last(folder, name="grains.dump"):
    return read_dump(folder / name)[-1][1]


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    folder = tmp_path_factory.mktemp("alone")
    return thermo(run_ok(refilled(WHOLE), folder)), last(folder)


def refilled(run):
    text = deck(fix=FIX, run=run, timestep=TIMESTEP, after=REFILL)
    return text.replace("custom 10", f"custom {STEPS // 2}").replace("thermo 5", "thermo 100")


def test_counts_close_and_nothing_hangs(alone):
    columns, frame = alone
    came = columns["Atoms"] + columns["f_drain[3]"] - len(lattice())
    assert came[-1] > 0.9 * STEPS and (np.diff(came[columns["Step"] > 0]) >= 0).all()
    assert columns["f_drain[3]"][-1] > 2.5 * len(lattice())
    new = frame["id"] > len(lattice())
    assert new.sum() > 0.7 * len(new)
    # The one that came last has not come down yet.
    assert len(hanging(frame, new)) <= 0.02 * new.sum() + 1
    assert (columns["f_drain[6]"] < 0.1).all()


@needs_mpirun
def test_on_three_ranks(alone, tmp_path):
    run_ok(refilled(WHOLE), tmp_path, launcher=on_ranks(3))
    assert same(last(tmp_path), alone[1])


@needs_mpirun
def test_over_a_restart(alone, tmp_path):
    """From two ranks to one."""
    run_ok(refilled(f"run {STEPS // 2}\nwrite_restart half"), tmp_path, launcher=on_ranks(2))
    rest = f"units lj\natom_style sphere\ninclude {LOAD_SPOT}\nread_restart half\n"
    rest += run_text(FIX, f"run {STEPS} upto", timestep=TIMESTEP, after=REFILL, dumps="rest.dump").replace("custom 10", "custom 1000")
    run_ok(rest, tmp_path)
    assert same(last(tmp_path, "rest.dump"), alone[1])


def same(one, other):
    return one["id"].tolist() == other["id"].tolist() and positions(one).tolist() == positions(other).tolist()
