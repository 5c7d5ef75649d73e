# SPDX-License-Identifier: GPL-2.0-or-later
"""Silos of other shapes: grains leave through the orifice and nowhere else."""

import numpy as np
import pytest

from lammps_runs import (OPENING, RATES, WALLS, deck, error_of, lattice, positions, programs, read_dump, run_ok, thermo,
                         write_data)

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


HOPPER = ("region hopper cone z 0 0 3 5.5 0 5\nregion bin cylinder z 0 0 5.5 5 19\n"
          "region pipe cylinder z 0 0 3 -4 1e-3\nregion silo union 3 hopper bin pipe")


@programs
def test_cone_hopper(tmp_path, program):
    """A hopper with its mouth as orifice, a straight part above it."""
    box = (-6, 6, -6, 6, -4, 20)
    log, frames = drained(tmp_path, "region silo", HOPPER, box=box,
                          fits=lambda x, y, z: np.hypot(x, y) <= cone_radius(z) - 0.6)
    assert log["f_drain[3]"][-1] > 40
    for frame in frames:
        x, y, z = positions(frame)[frame["z"] >= 0].T
        distance = (cone_radius(z) - np.hypot(x, y)) * np.where(z < 5, np.cos(np.arctan(0.5)), 1)
        assert distance.min() >= 0.5 - 2 * TOLERANCE


def read_spots(path):
    """Rows id, x, y, z of all spots in a local dump, over all its snapshots; and those of each by itself."""
    frames, rows = [], []
    for line in path.read_text().splitlines():
        if line.startswith("ITEM"):
            if line.startswith("ITEM: ENTRIES"):
                frames.append(rows := [])
            else:
                rows = []
        else:
            rows.append([float(word) for word in line.split()])
    frames = [np.array(frame).reshape(-1, 4) for frame in frames]
    return np.concatenate(frames), frames


def spots_of(folder, walls, before="", run="run 40", rates=RATES, **parts):
    """The spots of a drain, as read_spots() gives them. Steps of 1.3 d, as by default."""
    folder.mkdir(exist_ok=True)
    run_ok(deck(fix=f"fix drain all spot {walls} {OPENING} {rates} seed 1", before=before, run=run,
                after="dump spots all local 1 spots.dump f_drain[1] f_drain[2] f_drain[3] f_drain[4]", **parts), folder)
    return read_spots(folder / "spots.dump")


def test_spots_stay_in_a_hopper(tmp_path):
    """All of them, at every step: also those that would cross its wall in one step."""
    write_data(tmp_path / "packing.data", lattice(lambda x, y, z: np.hypot(x, y) <= cone_radius(z) - 0.6), box=(-6, 6, -6, 6, -4, 20))
    spots, _ = spots_of(tmp_path, "region silo", HOPPER)
    _, x, y, z = spots.T
    assert (z > 1).sum() > 500
    assert (np.hypot(x, y) - cone_radius(z))[z > 0].max() < 0
    # They come closer to the wall than half a step, by reflection: those that would only go up there stay away from it.
    assert (np.hypot(x, y) - cone_radius(z))[z > 5].max() > -0.6


PIPE = "region pipe cylinder z 0 0 3 -4 1e-3\n"


@pytest.mark.parametrize("walls, before", [
    (WALLS, PIPE + "region silo block -5 5 -4 4 0 90\nregion all_walls union 2 silo pipe"),
    (WALLS.replace("box -5.0", "box -4") + " buffer 1 2.6", PIPE + "region silo block -4 5 -4 4 0 90\nregion all_walls union 2 silo pipe"),
    (WALLS + " buffer 0.5 0", PIPE + "region silo block -5 5 -4 4 0 90\nregion all_walls union 2 silo pipe"),
], ids=["box", "wide buffers", "no base buffer"])
def test_spots_walk_in_regions_as_in_native_walls(tmp_path, walls, before):
    """Walks don't look at grains: with the same walls and buffers each spot takes the same way, to rounding."""
    write_data(tmp_path / "packing.data", lattice(lambda x, y, z: np.hypot(x, y) <= 3.5))
    (tmp_path / "region").mkdir()
    (tmp_path / "region" / "packing.data").write_bytes((tmp_path / "packing.data").read_bytes())
    buffers = " ".join(walls.split()[walls.split().index("buffer"):]) if "buffer" in walls else ""
    _, native = spots_of(tmp_path, walls)
    _, region = spots_of(tmp_path / "region", f"region all_walls {buffers}", before)
    common = 0
    for one, other in zip(native, region, strict=True):
        _, i, j = np.intersect1d(one[:, 0], other[:, 0], return_indices=True)  # the last spots to see a grain may differ
        np.testing.assert_allclose(one[i], other[j], atol=1e-4)
        common += len(i)
        assert len(i) >= 0.9 * len(one)
    assert common > 2000


@pytest.mark.parametrize("thickness", [0, 0.01, 0.5])
def test_spots_stay_on_their_side_of_a_baffle(tmp_path, thickness):
    """A plate beside the orifice, up to above the packing, thinner than a step: spots and flow stay on one side of it."""
    before = ("region silo block -5 5 -4 4 0 19\nregion pipe cylinder z -2 0 3 -4 1e-3\nregion both union 2 silo pipe\n"
              f"region plate block 1.5 {1.5 + thickness} -4 4 0.5 18 side out\nregion all_walls intersect 2 both plate")
    write_data(tmp_path / "packing.data", lattice(lambda x, y, z: x < 1 or x > 1.5 + thickness + 0.5))
    run_ok(deck(fix=f"fix drain all spot region all_walls orifice -2 0 0 3 {RATES} seed 1", before=before, run="run 40",
                after="dump spots all local 1 spots.dump f_drain[1] f_drain[2] f_drain[3] f_drain[4]"), tmp_path)
    spots, _ = read_spots(tmp_path / "spots.dump")
    assert len(spots) > 2000
    high = spots[:, 3] > 1
    assert 0.5 < spots[high, 1].max() <= 1.25 + 1e-4  # the buffer is 0.25


OPEN = "region f cone z 0 0 3 5.5 0 5 open 1 open 2\nregion b cylinder z 0 0 5.5 5 19 open 1\n"


@pytest.mark.parametrize("before, part", [
    (OPEN + "region silo union 2 f b", "f"),
    ("region f cone z 0 0 3 5.5 0 5\nregion b block -9 9 -9 9 -1 19 open 5\nregion silo intersect 2 f b", "b"),
    (OPEN.replace(" open 1\n", "\n") + "region u union 2 b f\nregion g block -9 9 -9 9 -1 19\nregion silo intersect 2 g u", "f"),
], ids=["union", "intersect", "nested"])
def test_open_parts_are_named(tmp_path, before, part):
    error = error_of(deck(fix=f"fix drain all spot region silo {OPENING} {RATES}", before=before), tmp_path)
    assert f"region '{part}', a part of 'silo', has an open face" in error
    assert "region pipe cylinder z 0 0 3 -6 0.003" in error


FLAT = "region floor block -5 5 -4 4 0 19\nregion pipe cylinder z 0 0 3 -4 1e-3\nregion silo union 2 floor pipe"


@pytest.mark.parametrize("before, orifice, says", [
    ("region f cone z 0 0 3 5.5 0 5\nregion b cylinder z 0 0 5.5 5 19\nregion silo union 2 f b", "0 0 0 3", "lies across"),
    (FLAT + "\nregion lid block -4 4 -4 4 0.1 0.2 side out\nregion shut intersect 2 silo lid", "0 0 0 3", "lies across"),
    (FLAT, "1.5 0 0 3", "reaches beyond the mouth"),
    (FLAT, "0 0 0 3.2", "reaches beyond the mouth"),
    (FLAT.replace("z 0 0 3", "z -2 0 1.5"), "2.5 0 0 2", "lies across"),
    ("region silo block -5 5 -4 4 0 19 open 5", "0 0 0 2.1", "is wider than"),
], ids=["closed", "lid", "beside", "wider", "elsewhere", "no floor"])
def test_orifice_and_mouth(tmp_path, before, orifice, says):
    """An orifice with a wall across it, or next to the mouth of the region: an error before anything moves."""
    region = before.rsplit("region ", 1)[1].split()[0]
    words = f"fix drain all spot region {region} orifice {orifice} profile uniform radius 2 {RATES}"
    error = error_of(deck(fix=words, before=before), tmp_path)
    radius = orifice.split()[-1]
    assert f"orifice of radius {radius} at ({orifice.split()[0]}, 0, 0)" in error and f"region '{region}'" in error and says in error


@pytest.mark.parametrize("walls, before, place", [
    (WALLS, "", (4.75, 0, 3)),
    ("cylinder 0 0 4", "", (0, 3.75, 3)),
    ("region silo", FLAT, (4, 3, 0.25)),
    ("region silo", FLAT, (4, 3, 0)),
    # The face between the hopper and the bin is closed below, open above: a grain above it lies on a floor.
    ("region silo", "region f cone z 0 0 3 5 0 5\nregion b cylinder z 0 0 3 4.5 19\nregion pipe cylinder z 0 0 3 -4 1e-3\n"
     "region silo union 3 f b pipe", (3.6, 0, 4.8)),
], ids=["box", "cylinder", "region", "at distance 0", "closed beside open"])
def test_grains_that_overlap_walls_are_named(tmp_path, walls, before, place):
    write_data(tmp_path / "packing.data", [(0, 0, 2), place])
    error = error_of(deck(fix=f"fix drain all spot {walls} {OPENING} {RATES}", before=before), tmp_path)
    assert "grain 2 overlaps a wall by " in error and "at most 0.03" in error


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


LID = "walls add block -5 5 -4 4 0 19 walls cut block -5 5 -4 4 8 10"
BEAM = "walls add block -5 5 -4 4 0 19 walls cut block -1.5 1.5 -4 4 8 10"


@pytest.mark.parametrize("walls, warned", [(LID, True), (BEAM, False)], ids=["lid", "beam"])
def test_spots_that_walls_hold_are_told(tmp_path, walls, warned):
    """Spots below a lid have no way to the bed; around a beam there is one."""
    inside = 5.0 if warned else 1.5
    write_data(tmp_path / "packing.data", lattice(lambda x, y, z: (abs(x) > inside + 0.5) | (z < 7.5) | (z > 10.5)))
    rates = RATES.replace("influence 1e-2", "influence 2e-3")  # or what is below the lid is out before spots are many
    screen = run_ok(deck(fix=f"fix drain all spot {walls} {OPENING} {rates} seed 1", run="run 250"), tmp_path)
    assert ("walls hold" in screen) == warned
