# SPDX-License-Identifier: GPL-2.0-or-later
"""Pour and drain a silo of 600 grains with the decks' own physics, through all that in.pour and in.drain write."""

import json
import os
import re
import shutil
import subprocess

import numpy as np
import pytest
from scipy.spatial import cKDTree

from liggghts_runs import DIAMETER, GRAVITY, MASS, TAU, read_dump, run, run_ok

SCENE = {"size": "small", "grains": 600, "half_width": 6, "pour_height": 30, "flux": 15000, "step": 2}
WALLS = np.array([6, 4]) * DIAMETER
SNAPSHOT = 10000  # steps in 2 tau
# One rank may share a core with others, and root may run it.
MPIRUN = ("mpirun", "--allow-run-as-root", "--oversubscribe", "-np")


def positions(columns):
    return np.column_stack([columns[axis] for axis in "xyz"])


def overlaps(x):
    pairs = cKDTree(x).query_pairs(DIAMETER, output_type="ndarray")
    return 1 - np.linalg.norm(x[pairs[:, 0]] - x[pairs[:, 1]], axis=1) / DIAMETER


@pytest.fixture(scope="module")
def silo(tmp_path_factory):
    """Output folder of a pour and a drainage of 8 tau, with the drainage's screen output."""
    out = tmp_path_factory.mktemp("silo")
    run_ok("silo", "in.pour", out=out, **SCENE)
    screen = run_ok("silo", "in.drain", out=out, time=8 * TAU, keep=4, **SCENE)
    return out, screen


@pytest.fixture(scope="module")
def packed(silo):
    (step, columns), = read_dump(silo[0] / "pour" / "packed.dump")
    assert step == 0
    return columns


@pytest.fixture(scope="module")
def snapshots(silo):
    frames = [read_dump(silo[0] / "drain" / f"drain.{step}.dump") for step in range(0, 5 * SNAPSHOT, SNAPSHOT)]
    return [frame[0] for frame in frames]


def test_packing_at_rest_inside_the_walls(packed):
    x = positions(packed)
    assert len(x) == 600
    assert (packed["id"] == np.arange(1, 601)).all()
    assert np.allclose(packed["radius"], DIAMETER / 2)
    velocity = np.column_stack([packed["v" + axis] for axis in "xyz"])
    assert MASS * (velocity**2).sum() / 2 / 600 < 1e-4 * MASS * GRAVITY * DIAMETER
    assert (np.abs(x[:, :2]).max(axis=0) < WALLS - 0.48 * DIAMETER).all()
    assert x[:, 2].min() > 0.48 * DIAMETER
    assert overlaps(x).max() < 0.02
    # 0.55 to 0.62 of the volume below the top layer, walls included
    height = np.sort(x[:, 2])[300]
    filling = 300 * np.pi / 6 * DIAMETER**3 / (4 * WALLS.prod() * height)
    assert 0.52 < filling < 0.64


def test_data_file_is_the_packing(silo, packed):
    text = (silo[0] / "pour" / "packed.data").read_text()
    atoms = text.split("Atoms")[1].split("Velocities")[0]
    rows = np.array([line.split() for line in atoms.strip().splitlines()], dtype=float)
    rows = rows[np.argsort(rows[:, 0])]
    assert np.allclose(rows[:, 1:4], (1, DIAMETER, 2500))
    assert np.allclose(rows[:, 4:7], positions(packed), atol=1e-9)


@pytest.mark.skipif(not shutil.which("lmp"), reason="no LAMMPS on the PATH")
def test_lammps_reads_the_data_file(silo, tmp_path):
    (tmp_path / "in.read").write_text("units si\natom_style sphere\nboundary f f f\nnewton off\n"
                                      f"read_data {silo[0]}/pour/packed.data\n"
                                      'variable kilograms equal mass(all)\nprint "weighs ${kilograms} kg"\n')
    done = subprocess.run(["lmp", "-in", "in.read", "-log", "none"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout
    assert "600 atoms" in done.stdout
    assert float(re.search(r"weighs (\S+) kg", done.stdout)[1]) == pytest.approx(600 * MASS)


@pytest.fixture(scope="module")
def cut_short(tmp_path_factory):
    """A pour that gave up before rest: pouring.1.restart is from within the pour (9,000 of 15,000 steps), pouring.2.restart from after it."""
    out = tmp_path_factory.mktemp("cut_short")
    done = run("silo", "in.pour", out=out, **{**SCENE, "keep": 1.8, "max_rest": 1})
    assert done.returncode != 0
    assert "ERROR: not at rest" in done.stdout
    assert not (out / "pour" / "packed.restart").exists()
    return out


@pytest.mark.parametrize("resume, begun", [(1, 9000), (2, 18000)])
def test_pour_goes_on_from_a_restart(cut_short, resume, begun, tmp_path):
    shutil.copytree(cut_short, tmp_path, dirs_exist_ok=True)
    screen = run_ok("silo", "in.pour", out=tmp_path, **{**SCENE, "resume": resume, "rest": 1e-2})
    assert re.search(r"^ *Step .*\n *(\d+)", screen, re.MULTILINE)[1] == str(begun)
    (step, columns), = read_dump(tmp_path / "pour" / "packed.dump")
    assert step == 0
    assert (columns["id"] == np.arange(1, 601)).all()
    assert overlaps(positions(columns)).max() < 0.02


def test_pour_goes_on_as_another_pour(cut_short):
    done = run("silo", "in.pour", out=cut_short, **{**SCENE, "resume": 1, "pour_speed": 12})
    assert done.returncode != 0
    assert "is of another pour" in done.stdout + done.stderr


@pytest.mark.parametrize("folder, step", [("pour", 2), ("drain", 2)])
def test_scene(silo, folder, step):
    scene = json.loads((silo[0] / folder / "scene.json").read_text())
    assert scene == pytest.approx({"format": 1, "program": "LIGGGHTS", "diameter": DIAMETER, "gravity": GRAVITY, "timestep": step * 1e-4 * TAU,
                                   "half_width_x": WALLS[0], "half_depth_y": WALLS[1], "orifice_radius": 4 * DIAMETER, "orifices": 1, "slot": False,
                                   "grains": 600})


def test_drainage_starts_from_the_packing(packed, snapshots):
    step, first = snapshots[0]
    assert step == 0
    assert np.array_equal(positions(first), positions(packed))


def test_grains_leave_through_the_orifice_only(snapshots):
    for _, columns in snapshots:
        x = positions(columns)
        assert (np.diff(columns["id"]) > 0).all()
        assert (np.abs(x[:, :2]).max(axis=0) < WALLS - 0.47 * DIAMETER).all()
        assert overlaps(x).max() < 0.03
        # Removed below -10 d, at the next neighbour list
        assert x[:, 2].min() > -10.5 * DIAMETER
        in_the_base = np.abs(x[:, 2]) < 0.3 * DIAMETER
        assert (np.hypot(x[in_the_base, 0], x[in_the_base, 1]) < 4 * DIAMETER).all()


def test_outflow(silo, snapshots):
    above = [int((columns["z"] > 0).sum()) for _, columns in snapshots]
    rows = [line.split() for line in silo[1].splitlines() if re.fullmatch(r"\s*\d+( +[\d.e+-]+){8}\s*", line)]
    table = {int(row[0]): row for row in rows}
    for index, count in enumerate(above):
        row = table[index * SNAPSHOT]
        assert float(row[1]) == pytest.approx(index * 2 * TAU, abs=1e-6)
        assert int(row[3]) == count
        columns = snapshots[index][1]
        mouth = np.abs(columns["z"]) < DIAMETER / 2
        assert float(row[4]) == pytest.approx(-columns["vz"][mouth].sum() / DIAMETER, rel=1e-3, abs=1)
    # Beverloo's law (C = 0.58, k = 1.4) says 74 /tau; a bed lower than the orifice is wide gives less.
    assert 45 < (above[1] - above[3]) / 4 < 75


def test_goes_on_from_a_restart(silo, tmp_path):
    scene = {**SCENE, "every": 0.02, "keep": 0.4, "time": 0.5 * TAU}
    run_ok("silo", "in.drain", out=tmp_path / "whole", start=silo[0] / "pour" / "packed.restart", **scene)
    run_ok("silo", "in.drain", out=tmp_path / "rest", start=tmp_path / "whole" / "drain" / "drain.2000.restart", **scene)
    # Not bit for bit: a start computes the forces with the velocities of the step, not of half a step before, and the flow
    # amplifies that. Losing the friction history moves grains by 4e-4 d and 1.4e-3 d.
    for step, tolerance in ((2000, 0), (2100, 1e-4), (2500, 5e-4)):
        (_, whole), = read_dump(tmp_path / "whole" / "drain" / f"drain.{step}.dump")
        (_, again), = read_dump(tmp_path / "rest" / "drain" / f"drain.{step}.dump")
        assert np.array_equal(again["id"], whole["id"])
        assert np.abs(positions(again) - positions(whole)).max() <= tolerance * DIAMETER
    assert not (tmp_path / "rest" / "drain" / "scene.json").exists()


def test_another_orifice_from_a_drainages_restart(silo, tmp_path):
    """The mesh in the restart must not win over the one asked for: what is left of the flow are grains already in the old hole."""
    restart = silo[0] / "drain" / f"drain.{2 * SNAPSHOT}.restart"
    run_ok("silo", "in.drain", out=tmp_path, start=restart, time=6 * TAU, **{**SCENE, "orifice": 1.2})
    (_, before), = read_dump(tmp_path / "drain" / f"drain.{2 * SNAPSHOT}.dump")
    (_, after), = read_dump(tmp_path / "drain" / f"drain.{3 * SNAPSHOT}.dump")
    assert (before["z"] > 0).sum() - (after["z"] > 0).sum() < 60


def test_one_opening_after_the_other(silo, tmp_path):
    """Slots in both halves: the right one first, then the left one, from the restart of that."""
    scene = {**SCENE, "slot": 1, "holes": 2, "orifice": 3, "out": tmp_path, "every": 1}
    run_ok("silo", "in.drain", start=silo[0] / "pour" / "packed.restart", time=1.5 * TAU, open=2, **scene)
    run_ok("silo", "in.drain", start=tmp_path / "drain" / f"drain.{SNAPSHOT}.restart", time=4 * TAU, open=1, **scene)
    frames = [read_dump(tmp_path / "drain" / f"drain.{tau * SNAPSHOT // 2}.dump")[0][1] for tau in (2, 4)]
    first, second = [frame["x"][frame["z"] < -0.5 * DIAMETER] for frame in frames]
    assert len(first) > 10 and (first > 0).all()
    assert (second < 0).sum() > 10


@pytest.mark.skipif(not shutil.which("mpirun"), reason="no mpirun on the PATH")
def test_two_ranks(silo, snapshots, tmp_path):
    done = run("silo", "in.drain", launcher=(*MPIRUN, "2"), out=tmp_path, start=silo[0] / "pour" / "packed.restart",
               time=2 * TAU, **SCENE)
    assert done.returncode == 0, done.stdout + done.stderr
    (_, columns), = read_dump(tmp_path / "drain" / f"drain.{SNAPSHOT}.dump")
    expected = snapshots[1][1]
    common, here, there = np.intersect1d(columns["id"], expected["id"], return_indices=True)
    # Sums in another order, then 2 tau of chaotic flow
    assert len(common) > 590
    moved = np.linalg.norm(positions(columns)[here] - positions(expected)[there], axis=1)
    assert np.median(moved) < 0.02 * DIAMETER


@pytest.mark.slow
def test_small_drains_as_fast_as_the_papers_silo(tmp_path):
    run_ok("silo", "in.pour", out=tmp_path, size="small")
    run_ok("silo", "in.drain", out=tmp_path, size="small", step=2, time=20 * TAU)
    above = [(read_dump(tmp_path / "drain" / f"drain.{step}.dump")[0][1]["z"] > 0).sum() for step in (2 * SNAPSHOT, 10 * SNAPSHOT)]
    # The 55,000 grains of the paper's silo give 69 to 71 /tau, Beverloo's law 74.
    assert (above[0] - above[1]) / 16 == pytest.approx(70, rel=0.06)


def test_packing_from_a_data_file(silo, packed, tmp_path):
    run_ok("silo", "in.from_data", out=tmp_path, data=silo[0] / "pour" / "packed.data", **SCENE)
    run_ok("silo", "in.drain", out=tmp_path, time=0.02 * TAU, every=0.02, **SCENE)
    (_, first), = read_dump(tmp_path / "drain" / "drain.0.dump")
    assert np.array_equal(first["id"], packed["id"])
    assert np.allclose(positions(first), positions(packed), atol=1e-9)


def test_a_loose_packing_settles(silo, packed, tmp_path):
    """Grains from half a diameter higher come down to the base again, and stay on it; the clock of the drainage starts then."""
    data = (silo[0] / "pour" / "packed.data").read_text()
    head, rest = data.split("Atoms", 1)
    atoms, velocities = rest.split("Velocities")
    lifted = [line.split() for line in atoms.splitlines()[2:] if line]
    for columns in lifted:
        columns[6] = repr(float(columns[6]) + 0.5 * DIAMETER)
    path = tmp_path / "lifted.data"
    path.write_text(f"{head}Atoms\n\n" + "\n".join(map(" ".join, lifted)) + f"\n\nVelocities{velocities}")
    screen = run_ok("silo", "in.from_data", out=tmp_path, data=path, settle=4, **SCENE)
    energy = float(re.search(r"600 grains of .*, kinetic energy (\S+) m g d a grain", screen).group(1))
    assert energy < 0.01
    run_ok("silo", "in.drain", out=tmp_path, time=0.02 * TAU, every=0.02, **SCENE)
    (step, first), = read_dump(tmp_path / "drain" / "drain.0.dump")
    assert step == 0 and np.array_equal(first["id"], packed["id"])
    assert 0.48 * DIAMETER < first["z"].min() < 0.5 * DIAMETER
    assert first["z"].mean() == pytest.approx(packed["z"].mean(), abs=0.3 * DIAMETER)


@pytest.mark.parametrize("change, message", [({"data": "no/such.data"}, "no data file no/such.data"),
                                             ({"settle": -1}, "settle is -1 tau"),
                                             ({"half_width": 4}, "has grains outside the silo")])
def test_bad_data_file(silo, change, message, tmp_path):
    done = run("silo", "in.from_data", out=tmp_path, **{"data": silo[0] / "pour" / "packed.data", **SCENE, **change})
    assert done.returncode != 0
    assert message in done.stdout + done.stderr


def test_periodic_along_y(tmp_path):
    scene = {**SCENE, "periodic": 1, "out": tmp_path}
    run_ok("silo", "in.pour", rest=1e-2, **scene)
    run_ok("silo", "in.drain", time=4 * TAU, **scene)
    (_, columns), = read_dump(tmp_path / "drain" / f"drain.{2 * SNAPSHOT}.dump")
    columns["y"] = columns.pop("yu")
    x = positions(columns)[columns["z"] > DIAMETER]
    period = 2 * WALLS[1]
    wrapped = (x[:, 1] + WALLS[1]) % period - WALLS[1]
    # No wall holds grains off half a diameter from it, and those at both ends keep off each other across them.
    assert (np.abs(wrapped) > WALLS[1] - 0.4 * DIAMETER).sum() > 10
    images = np.concatenate([np.column_stack([x[:, 0], wrapped + shift, x[:, 2]]) for shift in (-period, 0, period)])
    assert overlaps(images).max() < 0.02
    for folder in ("pour", "drain"):
        written = json.loads((tmp_path / folder / "scene.json").read_text())
        assert written["half_period_y"] == pytest.approx(WALLS[1]) and "half_depth_y" not in written


def test_two_sizes(tmp_path):
    """Half of the volume is that of grains 1.5 times as wide, and the mean volume that of a bead."""
    scene = {**SCENE, "ratio": 1.5, "step": 4, "out": tmp_path}
    run_ok("silo", "in.pour", rest=1e-2, **scene)
    (_, packed), = read_dump(tmp_path / "pour" / "packed.dump")
    small, large = np.unique(packed["radius"])
    assert large / small == pytest.approx(1.5, rel=1e-5) and len(packed["id"]) == 600
    volume = (2 * packed["radius"] / DIAMETER)**3
    assert volume.mean() == pytest.approx(1, abs=0.02)
    assert volume[packed["radius"] > 1.2 * small].sum() / volume.sum() == pytest.approx(0.5, abs=0.02)
    run_ok("silo", "in.drain", time=0.02 * TAU, every=0.02, **scene)
    (_, first), = read_dump(tmp_path / "drain" / "drain.0.dump")
    assert np.array_equal(first["radius"], packed["radius"])
    done = run("silo", "in.drain", time=0.02 * TAU, **{**scene, "ratio": 1})
    assert done.returncode != 0 and "are not beads of diameter" in done.stdout + done.stderr


BAD_POURS = [
    ({"ratio": 0.5}, "ratio (0.5) must be at least 1"),
    ({"ratio": 1.5, "share": 1.2}, "share (1.2) from 0 to 1"),
    ({"periodic": 2}, "periodic is 2"),
    ({"size": "huge"}, "no size huge"),
    ({"orifice": 9}, "an orifice of 9 d is wider than the base"),
    ({"orifice": 0}, "must be positive"),
    ({"slot": 2}, "slot is 2"),
    ({"holes": 0}, "holes (0)"),
    ({"holes": 2, "open": 3}, "open (3)"),
    ({"holes": 2}, "an orifice of 8 d is wider than the base"),
    ({"grains": 30000}, "30000 grains pile up to"),
    ({"grains": 0}, "grains (0)"),
    ({"flux": 90000}, "flux of 90000"),
    ({"flux": 0}, "flux (0)"),
    ({"resume": 1}, "pouring.1.restart: resume is 1"),
]


@pytest.mark.parametrize("change, message", BAD_POURS, ids=[str(change) for change, _ in BAD_POURS])
def test_bad_pour(change, message, tmp_path):
    done = run("silo", "in.pour", out=tmp_path, **{**SCENE, **change})
    assert done.returncode != 0
    assert message in done.stdout + done.stderr
    assert "Setting up run" not in done.stdout


def test_seed_that_is_no_prime(tmp_path):
    # stdbuf, because LIGGGHTS alone aborts before its own message has reached a pipe
    done = run("silo", "in.pour", launcher=("stdbuf", "-oL"), out=tmp_path, seed=15485864, **SCENE)
    assert done.returncode != 0
    assert "prime" in done.stdout + done.stderr


BAD_DRAINS = [
    ({"start": "no/such.restart"}, "no restart no/such.restart"),
    ({"half_width": 8}, "is of another silo"),
    ({"size": "paper", "half_width": 25}, "is of another silo"),
    ({"below": 5}, "is of another silo"),
    ({"density": 2600}, "are not beads"),
    ({"orifice": 8.5}, "an orifice of 8.5 d is wider than the base"),
    ({"sliver": 7}, "nothing of the base but slivers"),
    ({"python": "no-such-python"}, "no-such-python"),
    ({"time": 0}, "raise time"),
]


@pytest.mark.parametrize("change, message", BAD_DRAINS, ids=[str(change) for change, _ in BAD_DRAINS])
def test_bad_drain(silo, change, message, tmp_path):
    done = run("silo", "in.drain", out=tmp_path, **{"start": silo[0] / "pour" / "packed.restart", **SCENE, **change})
    assert done.returncode != 0
    assert message in done.stdout + done.stderr
    assert "Setting up run" not in done.stdout


def test_stale_mesh_is_not_used(silo, tmp_path):
    """When the base cannot be made, one from an earlier run must not stand in for it."""
    os.makedirs(tmp_path / "drain")
    shutil.copy(silo[0] / "drain" / "base.stl", tmp_path / "drain")
    done = run("silo", "in.drain", out=tmp_path, start=silo[0] / "pour" / "packed.restart", python="false", **SCENE)
    assert done.returncode != 0
