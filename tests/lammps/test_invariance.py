# SPDX-License-Identifier: GPL-2.0-or-later
"""What must not change the result of the time-ordered driver: the program, the order of the input, how the time is cut into steps and runs."""

import numpy as np
import pytest

import lammps_runs
from lammps_runs import DISTRIBUTION, LOAD_SPOT, lattice, needs_distribution, positions, programs, read_dump, run_ok, write_data

# Of the time-ordered driver; test_windowed.py is about the other one.
FIX = lammps_runs.FIX + " accuracy exact"


def deck(**parts):
    return lammps_runs.deck(**{"fix": FIX, **parts})


def drain(folder, **parts):
    return lammps_runs.drain(folder, **{"fix": FIX, **parts})


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    """The dump that every invariant variation has to repeat; grains have moved and left in it."""
    folder = tmp_path_factory.mktemp("reference")
    dump = drain(folder)
    first, *_, last = read_dump(folder / "grains.dump")
    assert len(last[1]["id"]) < len(first[1]["id"]) - 10
    return dump


@needs_distribution
def test_front_end_and_plugin_agree(reference, tmp_path):
    assert drain(tmp_path, program=DISTRIBUTION) == reference


@pytest.mark.parametrize("seed", range(2))
def test_order_of_input_atoms(reference, tmp_path, seed):
    points = lattice()
    order = np.random.default_rng(seed).permutation(len(points))
    write_data(tmp_path / "packing.data", points[order], ids=order + 1)
    assert drain(tmp_path) == reference


def frames(dump):
    return dump.split(b"ITEM: TIMESTEP\n")[1:]


def test_windows_per_step(tmp_path):
    """Four windows a step, or a step a window: v apart, which is displacement over the step, all is equal."""
    write_data(tmp_path / "packing.data", lattice())
    drain(tmp_path, fix=FIX + " window 0.025")
    coarse = read_dump(tmp_path / "grains.dump")
    drain(tmp_path, fix=FIX + " window 0.025", timestep=0.025, run="run 120")
    fine = {step: frame for step, frame in read_dump(tmp_path / "grains.dump")}
    for step, frame in coarse:
        other = fine[4 * step]
        for column in ("id", "x", "y", "z"):
            assert (frame[column] == other[column]).all()


def test_window_itself(reference, tmp_path):
    """The time-ordered driver knows no windows: only the moment of output matters."""
    assert drain(tmp_path, fix=FIX + " window 0.02") == reference


def test_run_in_pieces(reference, tmp_path):
    assert drain(tmp_path, run="run 7\nrun 3\nrun 13 pre no\nrun 7") == reference


def test_run_in_pieces_with_region(tmp_path):
    region = "region silo block -5 5 -4 4 0 20 open 5"
    fix = FIX.replace("box -5.0 5.0 -4.0 4.0", "region silo")
    assert "region silo" in fix
    (tmp_path / "one").mkdir()
    one = drain(tmp_path / "one", before=region, fix=fix)
    assert len(frames(one)) == 4
    assert drain(tmp_path / "pieces", before=region, fix=fix, run=30 * "run 1\n") == one


def test_run_every_and_upto(reference, tmp_path):
    assert drain(tmp_path, run='run 10 every 5 "print done"\nrun 30 upto') == reference


def test_communication_and_neighbour_settings(reference, tmp_path):
    assert drain(tmp_path, before="neighbor 0.7 bin\nneigh_modify every 3 delay 0 check no\natom_modify sort 2 2.0") == reference


@programs
def test_clear_and_load_again(reference, tmp_path, program):
    text = deck()
    run_ok(text + "\nclear\nshell rm grains.dump\n" + text, tmp_path, program=program)
    assert (tmp_path / "grains.dump").read_bytes() == reference


@programs
def test_load_twice(reference, tmp_path, program):
    assert drain(tmp_path, program=program, before=f"include {LOAD_SPOT}") == reference


def test_seeds(reference, tmp_path):
    assert drain(tmp_path, fix=FIX.replace("seed 1", "")) == reference  # the default
    other = drain(tmp_path, fix=FIX.replace("seed 1", "seed 2"))
    assert other != reference
    assert frames(other)[0] == frames(reference)[0]


def test_order_of_keywords(reference, tmp_path):
    words = FIX.split()
    head, rest = words[:4], words[4:]
    assert rest[:1] == ["box"]
    assert drain(tmp_path, fix=" ".join(head + rest[5:] + rest[:5])) == reference


def test_units_and_scale(tmp_path):
    """The same silo in SI units with grains of 3 mm: the same trajectory in diameters, as long as the difference in
    rounding, which grows as in any packing that flows, has not."""
    d, tau = 3e-3, (3e-3 / 9.81)**0.5
    drain(tmp_path, run="run 10")
    scaled = tmp_path / "si"
    scaled.mkdir()
    write_data(scaled / "packing.data", lattice(), diameter=d, density=2500)
    drain(scaled, units="si", timestep=0.1 * tau, run="run 10",
          fix=f"fix drain all spot box {-5 * d} {5 * d} {-4 * d} {4 * d} orifice 0 0 0 {3 * d} "
              f"influence 1e-2 speed {3.2 * d / tau:.15g} injection {100 / tau:.15g} seed 1 accuracy exact")
    lj, si = (read_dump(folder / "grains.dump")[-1][1] for folder in (tmp_path, scaled))
    assert (lj["id"] == si["id"]).all()
    assert np.abs(positions(lj) - lattice()).max() > 0.1
    assert np.abs(positions(lj) - positions(si) / d).max() < 1e-7
    assert np.abs(lj["vz"] - si["vz"] * tau / d).max() < 1e-6
