# SPDX-License-Identifier: GPL-2.0-or-later
"""The same invariances for the windowed driver, and the instruction set."""

import math
import re

import numpy as np
import pytest

from lammps_runs import DISTRIBUTION, FIX, ORIFICE, ROOT, deck, drain, lattice, needs_distribution, read_dump, run, run_ok, thermo, write_data

WINDOWED = FIX + " window 0.005 volume 77"  # and all that accuracy normal, the default, chooses
FAST = FIX + " window 0.02 influence 2e-2"  # few rounds of work for threads, which wait for cores that others use
REGION = "region silo block -5 5 -4 4 0 20 open 5"
IN_REGION = WINDOWED.replace("box -5.0 5.0 -4.0 4.0", "region silo")
assert "region silo" in IN_REGION


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


def test_fix_modify_changes_no_bit(reference, tmp_path):
    modified = "fix_modify drain threads 3\nrun 13\nfix_modify drain threads 2 dynamic/dof yes\nfix_modify drain energy no virial no\nrun 10"
    assert drain(tmp_path, fix=WINDOWED, run=f"run 7\n{modified}") == reference


def test_run_in_pieces_with_region(tmp_path):
    one = drain(tmp_path / "one", before=REGION, fix=IN_REGION)
    assert drain(tmp_path / "pieces", before=REGION, fix=IN_REGION, run=30 * "run 1\n") == one


@pytest.mark.parametrize("threads", [2, 3, 4])
def test_threads_with_region(tmp_path, threads):
    """LAMMPS' regions can be asked by one thread at a time only."""
    fix = IN_REGION.replace("window 0.005", "window 0.02")
    one = drain(tmp_path / "one", before=REGION, fix=fix, run="run 5")
    assert drain(tmp_path / "more", before=REGION, fix=f"{fix} threads {threads}", run="run 5") == one


@pytest.fixture(scope="module")
def short(tmp_path_factory):
    return drain(tmp_path_factory.mktemp("short"), fix=FAST, run="run 10")


@pytest.mark.parametrize("threads", range(1, 5))
@pytest.mark.parametrize("instruction_set", ["base", "x86-64-v3", "x86-64-v4"])
def test_instruction_sets_and_threads(short, tmp_path, instruction_set, threads):
    done = run(deck(fix=f"{FAST} threads {threads}", run="run 10"), tmp_path, SPOT_INSTRUCTION_SET=instruction_set)
    if "which this processor cannot run" in done.stdout + done.stderr:
        pytest.skip(f"this processor has no {instruction_set}")
    assert done.returncode == 0
    assert (tmp_path / "grains.dump").read_bytes() == short


def test_unknown_instruction_set(tmp_path):
    done = run(deck(fix=WINDOWED), tmp_path, SPOT_INSTRUCTION_SET="mmx")
    assert done.returncode != 0
    assert "SPOT_INSTRUCTION_SET is 'mmx'" in done.stdout + done.stderr


@pytest.mark.parametrize("rate, windows", [(100, 5), (10, 2)])  # the flow decides, then the climb
def test_default_window_is_a_fraction_of_the_timestep(tmp_path, rate, windows):
    """The longest one in which spots climb and grains flow no more than the documentation says."""
    text = " ".join((ROOT / "lammps-package" / "doc" / "fix_spot.rst").read_text().split())
    said = re.search(r"spots climb no more than ([\d.]+) grain diameters and the grains over the orifice go down by no more than "
                     r"([\d.]+) of them", text)
    climb, flow = (float(number) for number in said.groups())
    timestep, enclosed = 0.25, 0.58 * 8 * 0.4 * 3.53**3
    grains = timestep * rate * 1e-2 * enclosed  # of which pi/6 d^3 each go through the orifice
    longest = max(timestep * 3.2 / climb, grains / (6 * 0.58 * ORIFICE**2) / flow)
    assert math.ceil(longest - 1e-9) == windows
    fix = FIX.replace("injection 100", f"injection {rate}")
    default = drain(tmp_path / "default", fix=fix, timestep=timestep)
    assert drain(tmp_path / "given", fix=f"{fix} window {timestep / windows:.17g}", timestep=timestep) == default
    assert drain(tmp_path / "longer", fix=f"{fix} window {timestep / (windows - 1):.17g}", timestep=timestep) != default


@pytest.mark.parametrize("words", ["accuracy fast", "accuracy exact", "volume 0", "volume 70", "steps together", "momentum 0",
                                   "alpha 0.5", "relax tol 0.0123", "relax chance 5", "relax spot 5", "relax global 2",
                                   "relax never"])
def test_keyword_changes_the_trajectory(reference, tmp_path, words):
    assert drain(tmp_path, fix=f"{WINDOWED} {words}") != reference


def drained(folder, words):
    folder.mkdir()
    log = thermo(run_ok(deck(fix=f"{FIX} {words}", run="run 60"), folder))
    return log["f_drain[3]"][-1], log["f_drain[6]"].max()


@pytest.mark.parametrize("words", ["", "accuracy fast", "volume 77", "steps together"])
def test_drains_as_many_as_in_the_order_of_time(tmp_path, words):
    """With the same steps. Over seeds 1-5 the ratio is 0.95 +- 0.01 (twice), 1.03 +- 0.02 and 0.99 +- 0.02; the bound is the
    largest deviation of a mean and four standard deviations."""
    exact, _ = drained(tmp_path / "exact", words.replace("accuracy fast", "") + " dz 0.8 accuracy exact")
    windowed, overlap = drained(tmp_path / "windowed", words + " dz 0.8")
    assert exact > 200
    assert windowed == pytest.approx(exact, rel=0.1)
    assert overlap < 0.05
