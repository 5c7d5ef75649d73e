# SPDX-License-Identifier: GPL-2.0-or-later
"""examples/silo/in.silo_spot, a short stretch of it, on its real packing."""

import hashlib
import json
import os
import re
import subprocess

import numpy as np
import pytest
import scipy.spatial
import zstandard

from lammps_runs import DISTRIBUTION, FRONT_END, PLUGIN, ROOT, needs_distribution, needs_mpirun, on_ranks, thermo

SILO = ROOT / "examples" / "silo"
CHECKSUMS = SILO / "dumps.sha256"  # record_checksums.py writes it
RECORDED_TIME = 0.06               # s, of the checksums and of the stored logs


def run_example(program, out, launcher=(), log="none", **variables):
    """Snapshots of the deck as bytes, by step."""
    command = [*launcher, program, "-in", "in.silo_spot", "-log", str(log), "-var", "out", str(out)]
    for name, value in variables.items():
        command += ["-var", name, str(value)]
    done = subprocess.run(command, cwd=SILO, env={**os.environ, "SPOT_PLUGIN": PLUGIN}, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    return {step_of(path.name): zstandard.open(path, "rb").read()
            for path in sorted(out.glob("drain.*.dump.zst"), key=lambda path: step_of(path.name))}


def step_of(name):
    return int(name.split(".")[1])


@pytest.fixture(scope="module")
def snapshots(tmp_path_factory):
    out = tmp_path_factory.mktemp("front-end") / "made-by-the-deck"
    return out, run_example(FRONT_END, out, time=0.035)


def test_cadence_and_columns(snapshots):
    out, dumps = snapshots
    assert len(dumps) >= 2
    for dump in dumps.values():
        assert b"ITEM: ATOMS id type x y z radius vx vy vz\n" in dump
    scene = json.loads((out / "scene.json").read_text())
    assert scene["grains"] == 55000
    for k, step in enumerate(dumps):
        assert scene["timestep"] * step == pytest.approx(2 * k * (0.003 / 9.81)**0.5)  # 2 tau apart


def test_grains_move_and_leave(snapshots):
    first, *_, last = (np.loadtxt(dump.splitlines()[9:]) for dump in snapshots[1].values())
    assert len(first) == 55000 and 54000 < len(last) < 55000
    assert (abs(last[:, 2]) < 25 * 0.003).all() and (abs(last[:, 3]) < 4 * 0.003).all()
    fallen = first[np.searchsorted(first[:, 0], last[:, 0]), 4] - last[:, 4]
    assert fallen.max() > 0.003


@needs_distribution
def test_plugin_gives_the_same_bytes(snapshots, tmp_path):
    assert run_example(DISTRIBUTION, tmp_path / "out", time=0.035) == snapshots[1]


def test_seed(snapshots, tmp_path):
    other = run_example(FRONT_END, tmp_path / "out", time=0.02, seed=7)
    (start, _), (step, dump) = list(other.items())[:2]
    assert other[start] == snapshots[1][start]
    assert dump != snapshots[1][step]


def test_threads(snapshots, tmp_path):
    assert run_example(FRONT_END, tmp_path / "out", time=0.035, threads=3) == snapshots[1]


def test_silo_out_of_sample(tmp_path):
    """What analysis/one_material.py does to the deck: another packing, narrower walls and orifice."""
    out = tmp_path / "out"
    dumps = run_example(FRONT_END, out, time=0.035, packing="out-of-sample/packing.data.gz", half_width=16, orifice=6.5, outflow=22)
    scene = json.loads((out / "scene.json").read_text())
    assert scene["grains"] == 18000 and scene["half_width_x"] == pytest.approx(0.048)
    assert scene["orifice_radius"] == pytest.approx(3.25 * 0.003)
    last = np.loadtxt(list(dumps.values())[-1].splitlines()[9:])
    assert 17800 < len(last) < 18000 and (abs(last[:, 2]) < 16 * 0.003).all()


def test_stacked_bed(tmp_path):
    """Three layers of the packing, one upon the other: no two grains far inside each other, as dense as it, and nearly so at the seams."""
    bed = tmp_path / "stacked.data"
    done = subprocess.run([FRONT_END, "-in", "in.stack", "-var", "out", bed, "-log", "none"], cwd=SILO / "out-of-sample",
                          capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout[-3000:]
    atoms = bed.read_text().split("Atoms # sphere")[1].split("Velocities")[0].split()
    rows = np.array(atoms, dtype=float).reshape(-1, 10)
    positions = rows[:, 4:7] / 0.003
    assert len(rows) == 134999 and np.array_equal(np.sort(rows[:, 0]), np.arange(1, len(rows) + 1))
    assert scipy.spatial.cKDTree(positions).query(positions, 2)[0][:, 1].min() >= 0.979
    in_slabs = np.histogram(positions[:, 2], np.arange(0, 281, 20))[0]
    assert (in_slabs > 8900).all() and np.median(in_slabs) > 9150


def thermo_but_times(log):
    return {name: list(values) for name, values in thermo(log).items() if not name.startswith("CPU")}


def checksums(dumps):
    """SHA-256 of the text of each snapshot: how well it is compressed depends on the version of zstd."""
    return "".join(f"{hashlib.sha256(text).hexdigest()}  drain.{step}.dump\n" for step, text in dumps.items())


@pytest.fixture(scope="module", params=[1, pytest.param(4, marks=needs_mpirun)])
def recorded_run(request, tmp_path_factory):
    """Ranks, snapshots and log of the stretch of which checksums and logs are stored."""
    folder = tmp_path_factory.mktemp("recorded")
    launcher = on_ranks(request.param) if request.param > 1 else ()
    return request.param, run_example(FRONT_END, folder / "out", launcher, folder / "log", time=RECORDED_TIME), folder / "log"


def test_checksums(recorded_run):
    """The same bits on every system and with every version of LAMMPS."""
    _, dumps, _ = recorded_run
    assert len(dumps) == 3 and checksums(dumps) == CHECKSUMS.read_text()


def test_stored_log(recorded_run):
    """The same numbers, on as many ranks; how the logs were made is in examples/silo/README.md."""
    ranks, _, log = recorded_run
    (stored,) = SILO.glob(f"log.*.silo_spot.g++.{ranks}")
    expected = thermo_but_times(stored.read_text())
    assert len(expected) == 7 and len(expected["Step"]) == 3
    assert thermo_but_times(log.read_text()) == expected


def test_stored_logs_name_no_place_of_the_machine():
    for stored in SILO.glob("log.*"):
        assert not re.search(r"[ '\"]/\w+/|/(home|root|tmp|usr)/|\w@\w", stored.read_text()), stored.name
