# SPDX-License-Identifier: GPL-2.0-or-later
"""The number of MPI ranks, and how LAMMPS shares its box among them, change no bit of the dump."""

import re

import numpy as np
import pytest

from lammps_runs import (DISTRIBUTION, FIX, deck, drain, error_of, lattice, needs_distribution, needs_mpirun, on_ranks, run, run_ok,
                         thermo, write_data)

pytestmark = needs_mpirun

FIX = FIX + " volume 77"
REGION = "region silo block -5 5 -4 4 0 20 open 5"


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    return drain(tmp_path_factory.mktemp("alone"), fix=FIX)


@pytest.mark.parametrize("ranks", [2, 3, 4, 6])
def test_number_of_ranks(alone, tmp_path, ranks):
    assert drain(tmp_path, fix=FIX, launcher=on_ranks(ranks)) == alone


def test_what_spots_leave(tmp_path):
    fix = FIX + " profile uniform radius 2.5 volume 72 critical 0.56 1 dilatancy 0.1 full_strain 0.8 spread 0.6 0.7 nonaffine 0.1 0.5 closing 4e-3 0.1"
    drained = []
    for ranks in (1, 3, 4):
        (tmp_path / str(ranks)).mkdir()
        drained.append(drain(tmp_path / str(ranks), fix=fix, run="run 40", launcher=on_ranks(ranks)))
    assert drained[0] == drained[1] == drained[2]


@needs_distribution
def test_plugin(alone, tmp_path):
    assert drain(tmp_path, fix=FIX, program=DISTRIBUTION, launcher=on_ranks(2)) == alone


@pytest.mark.parametrize("grid", ["1 1 4", "4 1 1", "2 2 1", "1 2 2"])
def test_grid_of_processors(alone, tmp_path, grid):
    write_data(tmp_path / "packing.data", lattice())
    text = deck(fix=FIX).replace("read_data", f"processors {grid}\nread_data")
    run_ok(text, tmp_path, launcher=on_ranks(4))
    assert (tmp_path / "grains.dump").read_bytes() == alone


@pytest.mark.parametrize("before", ["balance 1.0 shift xyz 10 1.05",
                                    "fix even all balance 5 1.0 shift z 10 1.05",
                                    "comm_style tiled\nfix even all balance 5 1.0 rcb",
                                    "atom_modify sort 2 2.0\nneighbor 0.7 bin\nneigh_modify every 3 delay 0 check no"])
def test_how_lammps_shares_its_box(alone, tmp_path, before):
    assert drain(tmp_path, fix=FIX, before=before, launcher=on_ranks(3)) == alone


def test_order_of_input_atoms(alone, tmp_path):
    points = lattice()
    order = np.random.default_rng(3).permutation(len(points))
    write_data(tmp_path / "packing.data", points[order], ids=order + 1)
    assert drain(tmp_path, fix=FIX, launcher=on_ranks(2)) == alone


def test_threads_of_ranks(alone, tmp_path):
    assert drain(tmp_path, fix=FIX + " threads 2", launcher=on_ranks(2)) == alone


def test_run_in_pieces_with_a_region(tmp_path):
    fix = FIX.replace("box -5.0 5.0 -4.0 4.0", "region silo")
    one = drain(tmp_path / "one", before=REGION, fix=fix)
    assert drain(tmp_path / "pieces", before=REGION, fix=fix, run="run 7\nrun 23", launcher=on_ranks(3)) == one


def test_more_ranks_than_layers(tmp_path):
    """Grains in three layers of the grid; five ranks."""
    low = [point for point in lattice() if point[2] < 4.0]
    (tmp_path / "one").mkdir()
    (tmp_path / "five").mkdir()
    for folder in (tmp_path / "one", tmp_path / "five"):
        write_data(folder / "packing.data", np.array(low))
    one = drain(tmp_path / "one", fix=FIX)
    assert drain(tmp_path / "five", fix=FIX, launcher=on_ranks(5)) == one


def test_grains_that_somebody_else_moves_between_runs(tmp_path):
    change = "run 10\ngroup top id 900:999\ndisplace_atoms top move 0 0 0.5\nrun 20"
    assert drain(tmp_path / "two", fix=FIX, run=change, launcher=on_ranks(2)) == drain(tmp_path / "one", fix=FIX, run=change)


def test_thermo(tmp_path):
    """What the fix counts; the drained mass is a sum of numbers in an order that depends on the ranks."""
    (tmp_path / "one").mkdir()
    (tmp_path / "four").mkdir()
    one = thermo(run_ok(deck(fix=FIX), tmp_path / "one"))
    four = thermo(run_ok(deck(fix=FIX), tmp_path / "four", launcher=on_ranks(4)))
    assert one["f_drain[3]"][-1] > 10
    for column, values in one.items():
        assert four[column] == pytest.approx(values, rel=1e-12 if column == "f_drain[4]" else 0, abs=0), column


def highest():
    """ID of a grain at the top."""
    return int(np.argmax(lattice()[:, 2])) + 1


# Where nobody relaxes, grains are driven through the base; or somebody puts one into another.
COLLAPSES = {"first": (0, "window 0.01", "run 100", ["left through the base", "relax more"]),
             "last": (2, "window 0.001", f"run 1\ngroup top id {highest()}\ndisplace_atoms top move 0 0 -0.6\nrun 10",
                      ["overlap by", "when they are put in"])}


@pytest.mark.parametrize("where", COLLAPSES)
def test_collapse_on_one_rank_ends_all(tmp_path, where):
    """With the error that a single rank gives."""
    rank, window, runs, said = COLLAPSES[where]
    text = deck(fix=f"{FIX} relax tol 1 {window}", run=runs)
    alone = error_of(text, tmp_path)
    assert all(words in alone for words in ["grain", *said]), alone
    done = run(text, tmp_path, launcher=on_ranks(3))
    assert done.returncode != 0
    errors = re.findall(r"^ERROR on proc (\d): (.*) \(", done.stdout + done.stderr, flags=re.MULTILINE)
    assert errors == [(str(rank), alone[:alone.rindex(" (")])]
