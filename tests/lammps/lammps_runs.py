# SPDX-License-Identifier: GPL-2.0-or-later
"""A small silo, the deck that drains it, and the programs that run the deck, each in a process of its own.

Lengths are in grain diameters, times in sqrt(diameter / gravity), unless a deck says otherwise.
"""

import datetime
import os
import pathlib
import re
import shutil
import subprocess

import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
LOAD_SPOT = ROOT / "lammps-package" / "load_spot.lmp"
FRONT_END = os.environ.get("SPOT_LMP", str(ROOT / "build" / "bin" / "lmp"))
PLUGIN = os.environ.get("SPOT_PLUGIN", str(ROOT / "build" / "lib" / "spotplugin.so"))
DISTRIBUTION = shutil.which("lmp")

needs_distribution = pytest.mark.skipif(DISTRIBUTION is None or not os.path.exists(PLUGIN),
                                        reason="needs lmp on the PATH (Debian: apt install lammps) and the plugin")
# Both ways in: our own lmp, and the distribution's with the plugin.
programs = pytest.mark.parametrize("program", [pytest.param(FRONT_END, id="front-end"),
                                               pytest.param(DISTRIBUTION, id="plugin", marks=needs_distribution)])

needs_mpirun = pytest.mark.skipif(shutil.which("mpirun") is None, reason="needs mpirun")

HALF_WIDTH, HALF_DEPTH, HEIGHT, ORIFICE = 5.0, 4.0, 10.0, 3.0
BOX = (-HALF_WIDTH, HALF_WIDTH, -HALF_DEPTH, HALF_DEPTH, -4.0, 20.0)
WALLS = f"box {-HALF_WIDTH} {HALF_WIDTH} {-HALF_DEPTH} {HALF_DEPTH}"
OPENING = f"orifice 0 0 0 {ORIFICE}"
# Four times the influence of 2006 and a quarter of the births: the same outflow at a quarter of the cost.
RATES = "influence 1e-2 speed 3.2 injection 100"
FIX = f"fix drain all spot {WALLS} {OPENING} {RATES} seed 1"


def lattice(inside=lambda x, y, z: True):
    """A body-centred lattice at the packing fraction of dense flow, 0.58: no two grains of diameter 1 touch."""
    edge = 1.218
    corner = np.stack(np.meshgrid(*3 * [np.arange(-12, 13)], indexing="ij"), axis=-1).reshape(-1, 3) * edge
    points = np.concatenate([corner, corner + edge / 2]) + (0.1, 0.05, 0.3)
    x, y, z = points.T
    filled = (abs(x) <= HALF_WIDTH - 0.5) & (abs(y) <= HALF_DEPTH - 0.5) & (z >= 0.5) & (z <= HEIGHT)
    return points[filled & np.array([inside(*p) for p in points])]


def write_data(path, points, ids=None, diameter=1.0, box=BOX, diameters=None, density=1.0):
    """A LAMMPS data file of the points times `diameter`."""
    ids = range(1, len(points) + 1) if ids is None else ids
    diameters = len(points) * [diameter] if diameters is None else diameters
    lines = ["grains", "", f"{len(points)} atoms", "1 atom types", ""]
    lines += [f"{box[2 * k] * diameter:.15g} {box[2 * k + 1] * diameter:.15g} {axis}lo {axis}hi" for k, axis in enumerate("xyz")]
    lines += ["", "Atoms # sphere", ""]
    lines += [f"{grain} 1 {d:.15g} {density:.15g} " + " ".join(f"{c * diameter:.15g}" for c in point)
              for grain, point, d in zip(ids, points, diameters)]
    path.write_text("\n".join(lines) + "\n")


def run_text(fix, run, after="", timestep=0.1, dumps="grains.dump"):
    """The end of a deck, from the fix on; `after` are lines after it."""
    return f"""
{fix}
timestep {timestep}
thermo 5
thermo_style custom step atoms f_drain[*]
thermo_modify lost error format float %.15g
dump grains all custom 10 {dumps} id type x y z radius vx vy vz
dump_modify grains sort id format float %.17g
{after}
{run}
"""


def deck(fix=FIX, run="run 30", before="", units="lj", boundary="f f f", **parts):
    """A deck that drains packing.data; `before` are lines before the fix, `parts` those of run_text()."""
    return f"""
units {units}
atom_style sphere
boundary {boundary}
include {LOAD_SPOT}
read_data packing.data
{before}
""" + run_text(fix, run, **parts)


def on_ranks(ranks):
    """What starts a program on so many MPI ranks, more than there are cores if need be."""
    return ["mpirun", "--oversubscribe", "-np", str(ranks)] + (["--allow-run-as-root"] if os.geteuid() == 0 else [])


def run(text, folder, program=FRONT_END, launcher=(), **environment):
    """Run a deck in `folder`, which gets the small silo's packing.data unless it has one; the finished process."""
    if not (folder / "packing.data").exists():
        write_data(folder / "packing.data", lattice())
    (folder / "in.deck").write_text(text)
    done = subprocess.run([*launcher, program, "-in", "in.deck", "-log", "none", "-nocite"], cwd=folder,
                          env={**os.environ, "SPOT_PLUGIN": PLUGIN, **environment}, capture_output=True, text=True, errors="replace",
                          timeout=300)
    done.stdout = done.stdout.replace("\0", "")  # in one of 60 runs Open MPI 5's mpirun puts a zero before what it passes on
    return done


def run_ok(text, folder, **options):
    """The screen output of a deck that has to succeed."""
    done = run(text, folder, **options)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    return done.stdout


def run_example(folder, name, out, launcher=(), **variables):
    """The screen output of a deck of examples/, with its variables, that writes to the folder `out`."""
    words = [word for key, value in {"out": out, **variables}.items() for word in ("-var", key, str(value))]
    done = subprocess.run([*launcher, FRONT_END, "-in", name, "-log", "none", "-nocite", *words], cwd=ROOT / "examples" / folder,
                          env={**os.environ, "SPOT_PLUGIN": PLUGIN}, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    return done.stdout


def drain(folder, program=FRONT_END, launcher=(), **parts):
    """The dump, as bytes, of a deck made of these parts."""
    folder.mkdir(exist_ok=True)
    run_ok(deck(**parts), folder, program=program, launcher=launcher)
    return (folder / "grains.dump").read_bytes()


def lammps_version(program):
    """The date that is a LAMMPS' version."""
    said = subprocess.run([program, "-h"], capture_output=True, text=True, timeout=60).stdout
    return datetime.datetime.strptime(re.search(r"Simulator - (\d+ \w+ \d+)", said).group(1), "%d %b %Y").date()


def error_of(text, folder, **options):
    """The error message of a deck that has to fail."""
    done = run(text, folder, **options)
    said = done.stdout + done.stderr
    assert done.returncode != 0, said[-3000:]
    errors = re.findall(r"^ERROR[^:]*: (.*)$", said, flags=re.MULTILINE)
    assert len(set(errors)) == 1, said[-3000:]
    return errors[0]


def read_dump(path):
    """Frames of a text dump: a list of (step, {column: values})."""
    frames = []
    with open(path, encoding="ascii") as dump:
        while dump.readline():
            step = int(dump.readline())
            dump.readline()
            count = int(dump.readline())
            for _ in range(4):
                dump.readline()
            columns = dump.readline().split()[2:]
            rows = np.array([dump.readline().split() for _ in range(count)], dtype=float).reshape(count, len(columns))
            frames.append((step, dict(zip(columns, rows.T))))
    return frames


def positions(frame):
    return np.stack([frame[axis] for axis in "xyz"], axis=1)


def thermo(screen):
    """{column: values} of every line of thermo output; lines that two runs share stand twice."""
    rows, columns = [], []
    for line in screen.splitlines():
        words = line.split()
        if words[:1] == ["Step"]:
            columns = words
        elif columns and len(words) == len(columns) and re.fullmatch(r"\d+", words[0]):
            rows.append([float(word) for word in words])
    return dict(zip(columns, np.array(rows).T))
