# SPDX-License-Identifier: GPL-2.0-or-later
"""Grains of unequal size, of several types: same bits always, overlaps as small as with equal ones, volume closes."""

import gzip
import json
import re

import numpy as np
import pytest

from lammps_runs import (BOX, FIX, HEIGHT, LOAD_SPOT, ROOT, deck, drain, error_of, lattice, needs_mpirun, on_ranks,
                         positions, read_dump, run_example, run_ok, run_text, thermo, write_data)
from near_dem import assert_near_dem

ALL = FIX + " volume 77 dilation 0.03"
# Of grains 3 mm wide, were they equal.
MIXTURE = ROOT / "examples" / "bidisperse" / "packing-1.5.data.gz"
D, TAU = 3e-3, (3e-3 / 9.81)**0.5
W, N, BIRTHS = 1.5e-3, 77, 620  # births a tau


def mixed(count, low=0.5):
    """Diameters from `low` to 1, one of them 1."""
    diameters = np.random.default_rng(1).uniform(low, 1.0, count).round(6)
    diameters[0] = 1.0
    return diameters


def write_mixture(folder, diameters=None, points=None):
    """The small silo's packing with sizes; every third grain is of type 2."""
    points = lattice() if points is None else points
    folder.mkdir(exist_ok=True)
    write_data(folder / "packing.data", points, box=BOX[:5] + (60.0,),
               diameters=mixed(len(points)) if diameters is None else diameters)
    text = (folder / "packing.data").read_text().replace("1 atom types", "2 atom types")
    (folder / "packing.data").write_text(re.sub(r"^(\d*[369]) 1 ", r"\1 2 ", text, flags=re.MULTILINE))


def drained(folder, launcher=(), **parts):
    write_mixture(folder)
    return drain(folder, launcher=launcher, **{"fix": ALL, **parts})


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    return drained(tmp_path_factory.mktemp("reference"))


def test_grains_drain_with_their_sizes_and_types(reference, tmp_path):
    (tmp_path / "grains.dump").write_bytes(reference)
    first, last = (frame for _, frame in (read_dump(tmp_path / "grains.dump")[k] for k in (0, -1)))
    assert len(last["id"]) < len(first["id"]) - 20
    before = {grain: (radius, kind) for grain, radius, kind in zip(first["id"], first["radius"], first["type"])}
    assert all(before[grain] == (radius, kind) for grain, radius, kind in zip(last["id"], last["radius"], last["type"]))
    assert len(set(last["radius"])) > 100 and set(last["type"]) == {1, 2}


@needs_mpirun
@pytest.mark.parametrize("ranks", [2, 3])
def test_ranks(reference, tmp_path, ranks):
    assert drained(tmp_path, launcher=on_ranks(ranks)) == reference


def test_threads(reference, tmp_path):
    assert drained(tmp_path, fix=ALL + " threads 2") == reference


@needs_mpirun
@pytest.mark.parametrize("before, after", [(1, 3), (3, 1)])
def test_restart(reference, tmp_path, before, after):
    """d is that of the start, though large and small grains may have left in other shares."""
    drained(tmp_path, run="run 13\nwrite_restart half", launcher=on_ranks(before))
    rest = f"units lj\natom_style sphere\ninclude {LOAD_SPOT}\nread_restart half\n"
    run_ok(rest + run_text(ALL, "run 30 upto", dumps="rest.dump"), tmp_path, launcher=on_ranks(after))
    assert (tmp_path / "rest.dump").read_bytes().split(b"ITEM: TIMESTEP\n")[-1] == reference.split(b"ITEM: TIMESTEP\n")[-1]


def test_order_of_time(tmp_path):
    """Restarts and sizes with the driver of 2006."""
    exact = ALL + " accuracy exact"
    whole = drained(tmp_path / "whole", fix=exact, run="run 20")
    drained(tmp_path / "parts", fix=exact, run="run 10\nwrite_restart half")
    rest = f"units lj\natom_style sphere\ninclude {LOAD_SPOT}\nread_restart half\n"
    run_ok(rest + run_text(exact, "run 20 upto", dumps="rest.dump"), tmp_path / "parts")
    last = whole.split(b"ITEM: TIMESTEP\n")[-1]
    assert (tmp_path / "parts" / "rest.dump").read_bytes().split(b"ITEM: TIMESTEP\n")[-1] == last


def test_what_is_rounded_is_equal(tmp_path):
    """Six digits are what dumps have."""
    def places(folder, diameters):
        write_mixture(folder, diameters=diameters)
        drain(folder, fix=ALL)
        return positions(read_dump(folder / "grains.dump")[-1][1])
    equal = np.ones(len(lattice()))
    rounded = equal - np.where(np.arange(len(equal)) % 2, 4e-6, 0)
    assert (places(tmp_path / "equal", equal) == places(tmp_path / "rounded", rounded)).all()


def test_d_is_that_of_mean_volume(tmp_path):
    """What the command leaves open, in d: as if it had been given."""
    write_mixture(tmp_path)
    said = run_ok(deck(fix=ALL), tmp_path)
    open_ones = (tmp_path / "grains.dump").read_bytes()
    named = re.search(r"unequal size, up to (\S+) wide; one of mean volume, d, is (\S+) wide", said)
    mean = np.mean(mixed(len(lattice()))**3)**(1 / 3)
    assert float(named[1]) == 1.0 and float(named[2]) == pytest.approx(mean, rel=1e-7)
    given = f"{ALL} radius {3.53 * mean:.17g} diffusion {1.25 * mean:.17g} dz {1.2 * mean:.17g} buffer {0.25 * mean:.17g} {2 * mean:.17g}"
    drain(tmp_path, fix=given)
    one, other = (positions(read_dump(path)[1][1]) for path in (tmp_path / "grains.dump", _written(tmp_path / "open.dump", open_ones)))
    assert np.abs(one - other).max() < 1e-3  # d comes with nine digits, in which spots round another way


def _written(path, data):
    path.write_bytes(data)
    return path


def test_output_per_atom(tmp_path):
    """What has become of each grain, whatever its size; small ones are moved as often as large ones."""
    write_mixture(tmp_path)
    run_ok(deck(fix=ALL + " peratom yes", after="dump fates all custom 30 fates.dump id radius x y z f_drain[*]\n"
                                                "dump_modify fates sort id format float %.17g"), tmp_path)
    (_, first), (_, last) = read_dump(tmp_path / "fates.dump")
    stayed = np.isin(first["id"], last["id"])
    for k, axis in enumerate("xyz"):
        assert last[f"f_drain[{k + 1}]"] == pytest.approx(last[axis] - first[axis][stayed], abs=1e-6)
    small = last["radius"] < np.median(last["radius"])
    moves = last["f_drain[4]"]
    assert moves[small].mean() == pytest.approx(moves[~small].mean(), rel=0.1)


# ---- a mixture that DEM poured

@pytest.fixture(scope="module")
def mixture(tmp_path_factory):
    """Thermo output and snapshots of 20 tau; spots carry the same volume all the way."""
    folder = tmp_path_factory.mktemp("mixture")
    (folder / "packing.data").write_text(gzip.open(MIXTURE, "rt").read())
    fix = (f"fix drain all spot box {-10 * D} {10 * D} {-4 * D} {4 * D} orifice 0 0 0 {4 * D} influence {W} volume {N} "
           f"diffusion {1.47 * D} speed {6 * D / TAU} surface 2 nonaffine 0.15 {0.5 * D} closing 0.004 0.15 "
           f"injection {BIRTHS / TAU}")
    spots = "dump spots all local 4 spots.dump f_drain[1]\nthermo 4"
    said = run_ok(deck(fix=fix, units="si", timestep=0.5 * TAU, run="run 40", after=spots), folder)
    parts = (folder / "spots.dump").read_text().split("f_drain[1]")[1:]  # IDs count births
    births = [max((float(line) for line in part.split("ITEM")[0].split()), default=0) for part in parts]
    return thermo(said), read_dump(folder / "grains.dump"), births


def test_volume_closes(mixture):
    """What leaves in 16 tau is what newborn spots brought, in grains of mean volume."""
    log, frames, births = mixture
    volume = np.pi / 6 * np.mean((2 * frames[0][1]["radius"])**3)
    mass = dict(zip(log["Step"], log["f_drain[4]"]))
    left = (mass[40] - mass[8]) / 2500 / volume
    brought = (births[10] - births[2]) * W * N
    assert left > 1000
    assert left == pytest.approx(brought, rel=0.02)


def deepest_overlap(frame):
    """By pairs, over the mean of the two diameters."""
    x, radius = positions(frame), frame["radius"]
    deepest = 0.0
    for k in range(len(x) - 1):
        near = k + 1 + np.flatnonzero(np.abs(x[k + 1:, 2] - x[k, 2]) < 2 * radius.max())
        apart = np.linalg.norm(x[near] - x[k], axis=1) / (radius[near] + radius[k])
        deepest = max(deepest, *(1 - apart), 0.0)
    return deepest


def test_overlaps_stay_small(mixture):
    """As with equal grains, 0.02 d or so; and the fix names the deepest."""
    log, frames, _ = mixture
    largest = 2 * frames[0][1]["radius"].max()
    assert (log["f_drain[6]"] < 0.025 * largest).all()
    assert deepest_overlap(frames[-1][1]) == pytest.approx(log["f_drain[6]"][-1] / largest, abs=1e-6)


# ---- grains that come

def growing(low, high):
    return f"variable wide atom {low}+{high - low}*(id%10)/9\nset group new diameter v_wide\nset group new density 1.0"


COME = f"lattice sc 0.8\nregion top block -4 4 -3 3 15 18\ncreate_atoms 1 region top\ngroup new id > {len(lattice())}\n"


@needs_mpirun
def test_grains_of_other_sizes_come(tmp_path):
    for name, ranks in ("one", 1), ("three", 3):
        write_mixture(tmp_path / name)
        run_ok(deck(fix=ALL, run=f"run 10\n{COME}{growing(0.5, 1.0)}\nrun 20"), tmp_path / name, launcher=on_ranks(ranks))
    assert (tmp_path / "three" / "grains.dump").read_bytes() == (tmp_path / "one" / "grains.dump").read_bytes()
    last = read_dump(tmp_path / "one" / "grains.dump")[-1][1]
    new = last["id"] > len(lattice())
    assert new.sum() > 50 and last["z"].max() < HEIGHT + 6 and deepest_overlap(last) < 0.3


@pytest.mark.parametrize("low, high, said", [(0.6, 1.2, "diameters from 0.5 to 1, the largest at the start"),
                                             (0.4, 0.9, "has 0.4")])
def test_sizes_that_do_not_fit_may_not_come(tmp_path, low, high, said):
    write_mixture(tmp_path)
    assert said in error_of(deck(fix=ALL, run=f"run 5\n{COME}{growing(low, high)}\nrun 5"), tmp_path)


def test_equal_grains_may_become_unequal(tmp_path):
    """Those that come may be smaller than all before."""
    run_ok(deck(fix=ALL, run=f"run 5\n{COME}{growing(0.5, 1.0)}\nrun 25"), _tall(tmp_path))
    assert deepest_overlap(read_dump(tmp_path / "grains.dump")[-1][1]) < 0.3


def _tall(folder):
    write_data(folder / "packing.data", lattice(), box=BOX[:5] + (60.0,))
    return folder


# ---- what cannot be

def test_a_ratio_above_two_is_refused(tmp_path):
    diameters = mixed(len(lattice()), low=0.6)
    diameters[41] = 0.49
    write_mixture(tmp_path, diameters=diameters)
    error = error_of(deck(fix=ALL), tmp_path)
    assert "diameters from 0.5 to 1, the largest at the start" in error and "grain 42 has 0.49" in error


@needs_mpirun
@pytest.mark.parametrize("ranks", [1, 3])
def test_grains_keep_their_size(tmp_path, ranks):
    write_mixture(tmp_path)
    error = error_of(deck(fix=ALL, run="run 5\nset atom 300 diameter 0.77\nrun 5"), tmp_path, launcher=on_ranks(ranks))
    assert "grain 300 was" in error and "is 0.77 wide now: grains must keep their size" in error


# ---- the example

@pytest.mark.parametrize("ratio, said", [(1.5, "up to 0.00389"), (2, "up to 0.00495")])
def test_the_example_drains(tmp_path, ratio, said):
    """From 2 to 4 tau: what Beverloo's law predicts is 144 grains of mean volume, give or take the births of spots."""
    printed = run_example("bidisperse", "in.bidisperse", tmp_path, ratio=ratio, tau_run=10)
    assert said in printed and "Beverloo's law predicts an outflow of 4" in printed
    frames = [read_dump(tmp_path / f"drain.{step}.dump")[0][1] for step in (4, 8)]
    volume = [(frame["radius"]**3).sum() / (D / 2)**3 for frame in frames]
    assert volume[0] - volume[1] == pytest.approx(144, rel=0.15)
    assert json.loads((tmp_path / "scene.json").read_text())["grains"] == 5000
    # 10 tau. In the README: + 3 and + 8 % in outflow, - 4 and 0 % on the axis at 10 d, + 1 and + 12 % beside it, + 3 % in packing
    # fraction; large grains are half of what leaves, and a few grains of six tau make 10 % of it.
    assert_near_dem(tmp_path, f"bidisperse/dem-{ratio}.json", (4, 10), {
        "outflow": 0.13, "speed_10d_x1.0d": 0.20, "speed_10d_x5.0d": 0.27, "packing_fraction": 0.08, "large_share_left": 0.25})
