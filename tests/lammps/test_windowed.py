# SPDX-License-Identifier: GPL-2.0-or-later
"""The same invariances for the windowed driver, and the instruction set."""

import numpy as np
import pytest

from lammps_runs import DISTRIBUTION, FIX, deck, drain, lattice, needs_distribution, read_dump, run, write_data

WINDOWED = FIX + " relax tol 0.0015 window 0.005"


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    folder = tmp_path_factory.mktemp("reference")
    dump = drain(folder, fix=WINDOWED)
    first, *_, last = read_dump(folder / "grains.dump")
    assert len(last[1]["id"]) < len(first[1]["id"]) - 10
    return dump


@needs_distribution
def test_front_end_and_plugin_agree(reference, tmp_path):
    assert drain(tmp_path, program=DISTRIBUTION, fix=WINDOWED) == reference


def test_order_of_input_atoms(reference, tmp_path):
    points = lattice()
    order = np.random.default_rng(0).permutation(len(points))
    write_data(tmp_path / "packing.data", points[order], ids=order + 1)
    assert drain(tmp_path, fix=WINDOWED) == reference


def test_windows_per_step(reference, tmp_path):
    write_data(tmp_path / "packing.data", lattice())
    drain(tmp_path, fix=WINDOWED)
    coarse = read_dump(tmp_path / "grains.dump")
    drain(tmp_path, fix=WINDOWED, timestep=0.025, run="run 120")
    fine = dict(read_dump(tmp_path / "grains.dump"))
    for step, frame in coarse:
        for column in ("id", "x", "y", "z"):
            assert (frame[column] == fine[4 * step][column]).all()


def test_run_in_pieces(reference, tmp_path):
    assert drain(tmp_path, fix=WINDOWED, run="run 7\nrun 3\nrun 13 pre no\nrun 7") == reference


def test_run_in_pieces_with_region(tmp_path):
    region = "region silo block -5 5 -4 4 0 20 open 5"
    fix = WINDOWED.replace("box -5.0 5.0 -4.0 4.0", "region silo")
    assert "region silo" in fix
    one = drain(tmp_path / "one", before=region, fix=fix)
    assert drain(tmp_path / "pieces", before=region, fix=fix, run=30 * "run 1\n") == one


@pytest.mark.parametrize("instruction_set", ["base", "x86-64-v3", "x86-64-v4"])
def test_instruction_sets(reference, tmp_path, instruction_set):
    done = run(deck(fix=WINDOWED), tmp_path, SPOT_INSTRUCTION_SET=instruction_set)
    if "which this processor cannot run" in done.stdout + done.stderr:
        pytest.skip(f"this processor has no {instruction_set}")
    assert done.returncode == 0
    assert (tmp_path / "grains.dump").read_bytes() == reference


def test_unknown_instruction_set(tmp_path):
    done = run(deck(fix=WINDOWED), tmp_path, SPOT_INSTRUCTION_SET="mmx")
    assert done.returncode != 0
    assert "SPOT_INSTRUCTION_SET is 'mmx'" in done.stdout + done.stderr


def test_default_window_is_a_fraction_of_the_timestep(tmp_path):
    """0.016 d at 3.2 d a time unit is 0.005, a twentieth of the step."""
    given = drain(tmp_path / "given", fix=WINDOWED)
    assert drain(tmp_path / "default", fix=FIX + " relax tol 0.0015") == given
