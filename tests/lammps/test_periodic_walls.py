# SPDX-License-Identifier: GPL-2.0-or-later
"""Silos of shapes, and cylinders, in a simulation box that is periodic along y, or along x and y."""

import numpy as np
import pytest

from lammps_runs import LOAD_SPOT, OPENING, RATES, deck, needs_mpirun, on_ranks, positions, read_dump, run_ok, run_text, write_data
from test_periodic import BOX, DUMP, FILES, HALF, lattice

SLOT = f"slot 0 0 0 6 {2 * HALF}"
# A block less two planes that lean: as wide as the slot below, and wider by a diameter for each that it is higher.
WEDGE = f"walls add block -6 6 {-HALF} {HALF} 0 19 walls cut plane 3 0 0 1 0 -0.5 walls cut plane -3 0 0 -1 0 -0.5"
PILLAR = "walls cut cylinder z 0 5 0.9 -1 20"  # one end of the period is near
RATES = RATES.replace("injection 100", "injection 300") + " volume 77 seed 1 peratom yes"


def off_wedge(points):
    """Distance from the planes that lean."""
    return (3 + points[:, 2] / 2 - abs(points[:, 0])) / np.sqrt(1.25)


def off_pillar(points):
    y = points[:, 1] - 5 - 2 * HALF * np.rint((points[:, 1] - 5) / (2 * HALF))
    return np.hypot(points[:, 0], y) - 0.9


def drain(folder, walls, outlet, points, run="run 40", boundary="f p f", launcher=()):
    folder.mkdir(exist_ok=True)
    write_data(folder / "packing.data", points, box=BOX)
    run_ok(deck(fix=f"fix drain all spot {walls} {outlet} {RATES}", run=run, boundary=boundary, after=DUMP), folder, launcher=launcher)
    return [frame for _, frame in read_dump(folder / "fates.dump")]


def wedge_points():
    points = lattice("y")
    return points[off_wedge(points) > 0.5]


def pillar_points():
    points = lattice("y")
    return points[off_pillar(points) > 0.5]


def test_a_wedge_with_a_slot_from_side_to_side(tmp_path):
    """It drains as much where the cells meet as elsewhere, and each grain is counted once."""
    points = wedge_points()
    start, *others = drain(tmp_path, WEDGE, SLOT, points)
    for frame in others:
        at = positions(frame)
        assert off_wedge(at)[at[:, 2] > 0].min() > 0.4 and abs(at[:, 1]).max() <= HALF
    end = others[-1]
    gone = ~np.isin(start["id"], end["id"])
    assert gone.sum() > 200
    counts = np.histogram(start["y"][gone], np.linspace(-HALF, HALF, 5))[0]
    assert abs(counts - counts.mean()).max() < 4 * np.sqrt(counts.mean())
    crossed = end["iy"] != 0
    assert crossed.any()
    moved = end["yu"] - start["yu"][np.isin(start["id"], end["id"])]
    assert moved == pytest.approx(end["f_drain[2]"], abs=1e-9)


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    folder = tmp_path_factory.mktemp("alone")
    walls = f"walls add block -6 6 {-HALF} {HALF} 0 19 {PILLAR}"
    frames = drain(folder, walls, "orifice -1 0.5 0 3.2", pillar_points())
    for frame in frames:
        at = positions(frame)
        assert off_pillar(at)[at[:, 2] > 0].min() > 0.4
    assert len(frames[0]["id"]) - len(frames[-1]["id"]) > 100
    return walls, [(folder / name).read_bytes() for name in FILES]


@needs_mpirun
def test_ranks(alone, tmp_path):
    drain(tmp_path, alone[0], "orifice -1 0.5 0 3.2", pillar_points(), launcher=on_ranks(3))
    assert [(tmp_path / name).read_bytes() for name in FILES] == alone[1]


@needs_mpirun
def test_restart(alone, tmp_path):
    drain(tmp_path, alone[0], "orifice -1 0.5 0 3.2", pillar_points(), run="run 20\nwrite_restart half", launcher=on_ranks(2))
    fix = f"fix drain all spot {alone[0]} orifice -1 0.5 0 3.2 {RATES}"
    run_ok(f"units lj\natom_style sphere\ninclude {LOAD_SPOT}\nread_restart half\n" + run_text(fix, "run 40 upto", after=DUMP), tmp_path)
    for name, whole in zip(FILES, alone[1]):
        assert (tmp_path / name).read_bytes().split(b"ITEM: TIMESTEP")[-1] == whole.split(b"ITEM: TIMESTEP")[-1]


def test_a_cylinder_in_the_cell(tmp_path):
    """Walls all around it: nothing repeats inside."""
    points = lattice("")
    points = points[np.hypot(points[:, 0], points[:, 1]) < 5.4]
    frames = drain(tmp_path, "cylinder 0 0 6", OPENING, points, boundary="p p f")
    assert len(frames[0]["id"]) - len(frames[-1]["id"]) > 100
    for frame in frames:
        assert np.hypot(frame["x"], frame["y"]).max() < 5.6 and not frame["ix"].any() and not frame["iy"].any()
