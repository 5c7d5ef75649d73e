# SPDX-License-Identifier: GPL-2.0-or-later
"""Silos of other shapes: grains leave through the orifice and nowhere else."""

import numpy as np
import pytest

from lammps_runs import OPENING, RATES, WALLS, deck, lattice, positions, programs, read_dump, run_ok, thermo, write_data

TOLERANCE = 0.06  # of centres closer to a wall than the radius of a grain, in diameters


def cone_radius(z):
    """Radius of the hopper: 3 at its mouth, 5.5 at z = 5, then straight."""
    return np.clip(3 + z / 2, 3, 5.5)


def drained(folder, fix, regions="", fits=lambda x, y, z: True, box=None, run="run 40"):
    points = lattice(fits)
    write_data(folder / "packing.data", points, **({} if box is None else {"box": box}))
    screen = run_ok(deck(before=regions, fix=f"fix drain all spot {fix} {OPENING} {RATES} seed 1", run=run), folder)
    return thermo(screen), [frame for _, frame in read_dump(folder / "grains.dump")]


def test_cylinder(tmp_path):
    log, frames = drained(tmp_path, "cylinder 0 0 4", fits=lambda x, y, z: np.hypot(x, y) <= 3.5)
    assert log["f_drain[3]"][-1] > 40
    for frame in frames:
        assert np.hypot(frame["x"], frame["y"]).max() <= 3.5 + TOLERANCE


def test_region_against_native_box(tmp_path):
    """A block with a pipe through its floor is the box silo with its orifice, up to what rim and pipe do to grains.

    LAMMPS reports the faces of a region, not its edges: nothing holds a grain up whose centre is just inside the rim, and one that
    then is pushed outwards meets the floor from close by. The floor's reach is therefore asked of grains clear of the region's rim.
    """
    outflow = {}
    # The pipe's top face is open and inside the block: unions drop surfaces that are inside another part.
    regions = ("region silo block -5 5 -4 4 0 19\nregion pipe cylinder z 0 0 3 -4 1e-3\n"
               "region all_walls union 2 silo pipe")
    for name, walls, before, rim in [("box", WALLS, "", 0), ("region", "region all_walls", regions, 0.2)]:
        (tmp_path / name).mkdir()
        log, frames = drained(tmp_path / name, walls, before)
        outflow[name] = log["f_drain[3]"][-1]
        for frame in frames:
            x, y, z = positions(frame).T
            assert abs(x).max() <= 4.5 + TOLERANCE and abs(y).max() <= 3.5 + TOLERANCE
            from_axis = np.hypot(x, y)
            assert z[(z > 0) & (from_axis > 3 + rim)].min() >= 0.5 - TOLERANCE
            assert from_axis[z <= 0].max(initial=0) < 3.1
    assert outflow["region"] == pytest.approx(outflow["box"], rel=0.1)


@programs
def test_cone_hopper(tmp_path, program):
    """A hopper with its mouth as orifice, a straight part above it."""
    regions = ("region hopper cone z 0 0 3 5.5 0 5 open 1 open 2\nregion bin cylinder z 0 0 5.5 5 19 open 1\n"
               "region silo union 2 hopper bin")
    box = (-6, 6, -6, 6, -4, 20)
    log, frames = drained(tmp_path, "region silo", regions, box=box,
                          fits=lambda x, y, z: np.hypot(x, y) <= cone_radius(z) - 0.6)
    assert log["f_drain[3]"][-1] > 40
    for frame in frames:
        x, y, z = positions(frame)[frame["z"] >= 0].T
        distance = (cone_radius(z) - np.hypot(x, y)) * np.where(z < 5, np.cos(np.arctan(0.5)), 1)
        assert distance.min() >= 0.5 - 2 * TOLERANCE


def test_orifice_off_centre(tmp_path):
    """The orifice can be anywhere in the base, at any height."""
    points = lattice() + (0, 0, 2)
    write_data(tmp_path / "packing.data", points)
    run_ok(deck(fix=f"fix drain all spot {WALLS} orifice -1.5 0.5 2 3 {RATES} outlet 1", run="run 40"), tmp_path)
    first, *_, last = [frame for _, frame in read_dump(tmp_path / "grains.dump")]
    assert len(first["id"]) - len(last["id"]) > 40
    below = last["z"] < 2
    assert below.any() and last["z"].min() >= 1
    assert np.hypot(last["x"][below] + 1.5, last["y"][below] - 0.5).max() < 3.1
