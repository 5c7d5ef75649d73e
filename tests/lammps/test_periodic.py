# SPDX-License-Identifier: GPL-2.0-or-later
"""Silos that repeat along x, y or both: what LAMMPS is told of grains that leave on one side and come in on the other."""

import re

import numpy as np
import pytest

from lammps_runs import (LOAD_SPOT, OPENING, RATES, deck, error_of, needs_mpirun, on_ranks, positions, read_dump, run_ok, run_text, thermo,
                         write_data)

HALF = 6.0  # of the cell along x and y: a period holds two influences of the default radius
BOX = (-HALF, HALF, -HALF, HALF, -4.0, 20.0)
BOUNDARY = {"x": "p f f", "y": "f p f", "xy": "p p f"}
ALL = "volume 77 critical 0.56 0.5 dilatancy 0.1 full_strain 0.3 spread 0.6 0.7 surface 3 dilation 0.03 nonaffine 0.1 0.5 closing 4e-3 0.1"
DUMP = """dump fates all custom 10 fates.dump id x y z xu yu zu ix iy iz f_drain[1] f_drain[2] f_drain[3] f_drain[4]
dump_modify fates sort id format float %.17g
dump spots all local 10 spots.dump f_drain[1] f_drain[2] f_drain[3] f_drain[4]
dump_modify spots sort 1 format float %.17g"""
FILES = ("grains.dump", "fates.dump", "spots.dump")


def lattice(axes, height=10.0):
    """A body-centred lattice that repeats along both axes, a little shaken, with a layer on the ends of the cell; half a diameter off
    the walls where there are some."""
    edge = np.array([1.2, 1.2, 1.25])
    corner = np.stack(np.meshgrid(np.arange(-5, 5), np.arange(-5, 5), np.arange(12), indexing="ij"), axis=-1).reshape(-1, 3) * edge
    points = np.concatenate([corner, corner + edge / 2]) + (0, 0, 0.6)
    points += np.random.default_rng(1).uniform(-0.01, 0.01, points.shape)
    points[:, :2] += 2 * HALF * ((points[:, :2] < -HALF) * 1.0)
    kept = points[:, 2] < height
    for axis, name in enumerate("xy"):
        kept &= (name in axes) | (abs(points[:, axis]) <= HALF - 0.5)
    return points[kept]


def fix_of(axes, more=ALL):
    walls = " ".join("NULL NULL" if name in axes else f"{-HALF} {HALF}" for name in "xy")
    return f"fix drain all spot box {walls} {OPENING} {RATES} seed 1 peratom yes {more}"


def drain(folder, axes="y", more=ALL, run="run 40", launcher=(), points=None, box=BOX, **parts):
    """Runs the deck; the dumps, as bytes, and what it said."""
    folder.mkdir(exist_ok=True)
    write_data(folder / "packing.data", lattice(axes) if points is None else points, box=box)
    said = run_ok(deck(fix=fix_of(axes, more), run=run, boundary=BOUNDARY[axes], after=DUMP, **parts), folder, launcher=launcher)
    return [(folder / name).read_bytes() for name in FILES], thermo(said)


def fates(folder):
    return [frame for _, frame in read_dump(folder / "fates.dump")]


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    return drain(tmp_path_factory.mktemp("alone"))[0]


@pytest.mark.parametrize("axes", ["x", "y", "xy"])
@pytest.mark.parametrize("accuracy", ["normal", "exact"])
def test_image_flags_and_unwrapped_positions(tmp_path, axes, accuracy):
    """Grains stay in the cell; unwrapped, they are where their displacement has taken them from the start."""
    drain(tmp_path, axes, ALL.replace("dilation 0.03", "") + f" accuracy {accuracy}", run="run 20\nrun 20")
    start, *_, end = fates(tmp_path)
    left = np.isin(start["id"], end["id"])
    assert 0 < left.sum() < len(left)
    for number, name in enumerate("xyz", 1):
        moved = end[f"{name}u"] - start[f"{name}u"][left]
        assert moved == pytest.approx(end[f"f_drain[{number}]"], abs=1e-9)
        period = 2 * HALF if name in axes else 0
        assert end[f"{name}u"] == pytest.approx(end[name] + end[f"i{name}"] * period, abs=1e-9)
        crossed = end[f"i{name}"] != 0
        assert crossed.any() == (name in axes)
        if name in axes:
            assert end[name].min() >= -HALF and end[name].max() < HALF
            # both ways, so that a sign which is wrong does not go unnoticed
            assert (end[f"i{name}"] < 0).any() and (end[f"i{name}"] > 0).any()
            assert abs(moved[crossed]).max() < 3
    _, last = read_dump(tmp_path / "grains.dump")[-1]
    assert abs(np.stack([last[f"v{name}"] for name in "xyz"])).max() < 20  # 120 would be a period a step


@pytest.mark.parametrize("axes", ["x", "xy"])
def test_largest_overlap_is_that_of_all_images(tmp_path, axes):
    values = drain(tmp_path, axes, run="run 20")[1]
    places = positions(fates(tmp_path)[-1])
    apart = places[:, None] - places
    for axis, name in enumerate("xy"):
        if name in axes:
            apart[..., axis] -= 2 * HALF * np.rint(apart[..., axis] / (2 * HALF))
    distance = np.sqrt((apart**2).sum(axis=2))[np.triu_indices(len(places), 1)]
    assert values["f_drain[6]"][-1] == pytest.approx(max(1 - distance.min(), 0), abs=1e-9)


def test_spots_are_in_the_cell(tmp_path):
    drain(tmp_path, "xy")
    rows = [line.split() for line in (tmp_path / "spots.dump").read_text().split("ITEM: ENTRIES")[-1].splitlines()[1:]]
    places = np.array(rows, dtype=float)[:, 1:3]
    assert len(places) > 50
    assert places.min() >= -HALF and places.max() < HALF
    assert (abs(places) > HALF - 1).any(axis=0).all()  # they come as far as its ends


@needs_mpirun
@pytest.mark.parametrize("ranks, before", [(2, ""), (3, ""), (4, ""), (4, "processors 1 4 1"), (4, "processors 2 2 1"),
                                           (3, "fix even all balance 5 1.0 shift y 10 1.05"),
                                           (3, "comm_style tiled\nfix even all balance 5 1.0 rcb")])
def test_ranks(alone, tmp_path, ranks, before):
    text = before if before.startswith("processors") else ""
    write_data(tmp_path / "packing.data", lattice("y"), box=BOX)
    whole = deck(fix=fix_of("y"), run="run 40", boundary=BOUNDARY["y"], after=DUMP, before="" if text else before)
    run_ok(whole.replace("read_data", f"{text}\nread_data"), tmp_path, launcher=on_ranks(ranks))
    assert [(tmp_path / name).read_bytes() for name in FILES] == alone


@pytest.mark.parametrize("more, before", [("threads 3", ""), ("", "atom_modify sort 2 2.0"),
                                          ("", "neighbor 0.7 bin\nneigh_modify every 3 delay 0 check no"),
                                          ("", "neigh_modify every 1 delay 0 check no")])
def test_threads_and_when_lammps_wraps(alone, tmp_path, more, before):
    assert drain(tmp_path, more=f"{ALL} {more}", before=before)[0] == alone


def last_frames(files):
    """Of grains and of their fates; LAMMPS writes no more of the spots at the start of a run."""
    return [text.split(b"ITEM: TIMESTEP")[-1] for text in files]


def rest_of(fix, before="", after=DUMP):
    return (f"units lj\natom_style sphere\ninclude {LOAD_SPOT}\nread_restart half.restart\n{before}\n"
            + run_text(fix, "run 40 upto", after=after))


@needs_mpirun
@pytest.mark.parametrize("before, after", [(1, 1), (1, 3), (3, 2)])
def test_restart(alone, tmp_path, before, after):
    drain(tmp_path, run="run 20\nwrite_restart half.restart", launcher=on_ranks(before))
    run_ok(rest_of(fix_of("y")), tmp_path, launcher=on_ranks(after))
    assert last_frames([(tmp_path / name).read_bytes() for name in FILES]) == last_frames(alone)


def test_restart_in_another_cell(tmp_path):
    fix = fix_of("y").replace("peratom yes", "")  # or LAMMPS lets nobody change its box
    write_data(tmp_path / "packing.data", lattice("y"), box=BOX)
    run_ok(deck(fix=fix, run="run 10\nwrite_restart half.restart", boundary="f p f"), tmp_path)
    error = error_of(rest_of(fix, "change_box all y final -6.0 6.5", after=""), tmp_path)
    assert "walls was box -6 6 NULL NULL periodic y -6 6 in" in error and "is box -6 6 NULL NULL periodic y -6 6.5 now" in error


def test_run_in_pieces(alone, tmp_path):
    assert drain(tmp_path, run="run 7\nrun 13 pre no\nrun 20")[0] == alone


def test_grains_that_others_move(tmp_path):
    """By a whole period, which changes nothing; only the image flags tell."""
    plain = drain(tmp_path / "plain", run="run 10\nrun 20")[0]
    moved = drain(tmp_path / "moved", run="run 10\ndisplace_atoms all move 0 12 0 units box\nrun 20")[0]
    assert moved[0] == plain[0]
    for one, other in zip(fates(tmp_path / "plain")[2:], fates(tmp_path / "moved")[2:]):
        assert (other["y"] == one["y"]).all() and (other["iy"] == one["iy"] + 1).all()


@pytest.mark.parametrize("more", [ALL, ALL.replace("dilation 0.03", "") + " accuracy exact"])
def test_where_the_cell_begins_is_of_no_account(tmp_path, more):
    """Moved by a quarter of a period along y, grains and orifice drain in the same way, to rounding."""
    drain(tmp_path / "here", more=more)
    points = lattice("y") - (0, HALF / 2, 0)
    points[points[:, 1] < -HALF, 1] += 2 * HALF
    write_data(tmp_path / "packing.data", points, box=BOX)
    fix = fix_of("y", more).replace(OPENING, f"orifice 0 {-HALF / 2} 0 3.0")
    run_ok(deck(fix=fix, run="run 40", boundary="f p f", after=DUMP), tmp_path)
    for here, there in zip(fates(tmp_path / "here"), fates(tmp_path)):
        assert (here["id"] == there["id"]).all()
        for number in (1, 2, 3, 4):
            assert here[f"f_drain[{number}]"] == pytest.approx(there[f"f_drain[{number}]"], abs=1e-6), abs(here[f"f_drain[{number}]"] - there[f"f_drain[{number}]"]).max()


@pytest.mark.parametrize("axes, boundary, box, said", [
    ("y", "f f f", BOX, ["NULL NULL for walls along y", "not periodic there", "'boundary p'"]),
    ("x", "p p f", BOX, ["'box' has walls along y", "simulation box is periodic", "NULL NULL"]),
    ("y", "f p f", (*BOX[:2], -5.5, 5.5, *BOX[4:]), ["period along y is 11 ", "at least 11.06", "twice the sum of the spot radius"]),
    ("xy", "p p f", (-5.0, 5.0, *BOX[2:]), ["period along x is 10 ", "at least 11.06"]),
])
def test_periods_and_walls(tmp_path, axes, boundary, box, said):
    points = lattice("")
    points = points[(abs(points[:, 0]) < box[1] - 0.5) & (abs(points[:, 1]) < box[3] - 0.5)]
    write_data(tmp_path / "packing.data", points, box=box)
    error = error_of(deck(fix=fix_of(axes), run="run 1", boundary=boundary), tmp_path)
    assert all(words in error for words in said), error


@pytest.mark.parametrize("walls, said", [
    ("box -6 6 NULL 6", "'box' has NULL for ylo but not for yhi"), ("box -6 6 -6 NULL", "'NULL' is not a finite number"),
    ("cylinder 0 0.5 6", "walls along y, at -5.5 and 6.5, are not within the simulation box"),
    ("walls add block -6 6 -6 5.5 0 19 walls cut sphere 0 5 3 2", "'walls cut sphere 0 5 3 2': space repeats along y, from -6 to 6"),
    ("walls add block -6 6 -6 6 0 19 walls cut plane 0 0 9 0 0.1 1", "without a change along y"),
    ("region silo", "walls of a region cannot repeat"),
])
def test_other_walls(tmp_path, walls, said):
    write_data(tmp_path / "packing.data", lattice("y"), box=BOX)
    fix = f"fix drain all spot {walls} {OPENING} {RATES}"
    error = error_of(deck(fix=fix, run="run 1", boundary="f p f", before="region silo block -5 5 -5 5 0 19"), tmp_path)
    assert said in error, error


@pytest.mark.parametrize("change, said", [
    ("fix grow all deform 1 y scale 1.1 remap x", "does not work in a periodic simulation box that changes in a run"),
    ("run 1\nchange_box all y final -6 6.5", "repeats otherwise than in the last run"),
])
def test_box_that_changes(tmp_path, change, said):
    write_data(tmp_path / "packing.data", lattice("y"), box=BOX)
    assert said in error_of(deck(fix=fix_of("y"), run=f"{change}\nrun 5", boundary="f p f"), tmp_path)


def test_an_outlet_that_reaches_out_of_the_cell(tmp_path):
    write_data(tmp_path / "packing.data", lattice("y"), box=BOX)
    fix = fix_of("y").replace(OPENING, "orifice 0 4 0 3.0")
    assert "reaches out of the cell that repeats, along y from -6 to 6" in error_of(deck(fix=fix, run="run 1", boundary="f p f"), tmp_path)


def test_a_slot_from_side_to_side(tmp_path):
    """It has no rim where the cells meet: as much leaves there as elsewhere, and nothing stays."""
    points = lattice("y")
    fix = fix_of("y", "volume 77").replace(OPENING, "slot 0 0 0 6 12").replace("injection 100", "injection 300")
    write_data(tmp_path / "packing.data", points, box=BOX)
    run_ok(deck(fix=fix, run="run 60", boundary="f p f", after=DUMP), tmp_path)
    start, *_, end = fates(tmp_path)
    gone = ~np.isin(start["id"], end["id"])
    near = gone & (abs(start["x"]) < 3)
    middle, seam = ((near & inside).sum() for inside in (abs(start["y"]) < 3, abs(start["y"]) >= 3))
    assert middle + seam > 200
    assert abs(middle - seam) < 4 * np.sqrt(middle + seam)
    # a rim would hold grains at its height, over what is open
    over = (abs(end["x"]) < 2) & (end["z"] < 1)
    fall = end["f_drain[3]"][over]
    assert over.sum() > 5 and fall.max() < -0.5


def test_beverloo_for_a_slot_from_side_to_side(tmp_path):
    """A length of which nothing is taken off."""
    fix = fix_of("y", "volume 77").replace(OPENING, "slot 0 0 0 7 12").replace("injection 100", "beverloo 1.0")
    write_data(tmp_path / "packing.data", lattice("y"), box=BOX)
    said = run_ok(deck(fix=fix, run="run 1", boundary="f p f"), tmp_path)
    outflow = float(re.search(r"outflow of ([\d.]+) grains per time through the slot of 7 by 12 without ends along y", said)[1])
    assert outflow == pytest.approx(1.03 * 0.58 * 6 / np.pi * 12 * (7 - 1.4)**1.5, rel=1e-4)
