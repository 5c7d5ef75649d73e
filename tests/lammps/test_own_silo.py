# SPDX-License-Identifier: GPL-2.0-or-later
"""One's own silo, from a dump of DEM to a run: what spot-import writes, spot-check looks at, and lmp drains."""

import gzip
import subprocess
import sys

import numpy as np
import pytest

from lammps_runs import FRONT_END, ROOT

HOPPER = ROOT / "examples" / "own-hopper" / "packing.data.gz"


def command(name, *words, cwd):
    return subprocess.run([sys.executable, "-B", str(ROOT / "analysis" / name), *map(str, words)], cwd=cwd, capture_output=True, text=True,
                          timeout=300)


def beads():
    """Positions (8000, 3), m, in the order of ids."""
    rows = np.array(gzip.open(HOPPER, "rt").read().split("Atoms # sphere")[1].split(), dtype=float).reshape(-1, 7)
    return rows[np.argsort(rows[:, 0]), 4:]


def write_dump(path):
    """The hopper as LIGGGHTS writes it, in mm, gravity along -y, the outlet at y = 20 mm."""
    x, y, z = beads().T * 1000
    rows = "".join(f"{k} 1 {a:.9g} {b:.9g} {c:.9g} 1.5\n" for k, (a, b, c) in enumerate(zip(x, z + 20, -y), 1))
    path.write_text("ITEM: TIMESTEP\n50000\nITEM: NUMBER OF ATOMS\n8000\nITEM: BOX BOUNDS ff ff ff\n-31 31\n-10 230\n-31 31\n"
                    f"ITEM: ATOMS id type x y z radius\n{rows}")


@pytest.fixture(scope="module", params=[["--cone", 0, 0, 0.012, 0.03, 0.045], ["--fit", "cone-and-cylinder"]], ids=["named", "fitted"])
def imported(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("own")
    write_dump(folder / "fill.dump")
    done = command("import_packing.py", "fill.dump", *"--length-unit mm --gravity -y --floor 0.02 --orifice 0.012 --outflow 5700".split(),
                   "--run", 20, *request.param, cwd=folder)
    assert done.returncode == 0, done.stderr
    assert "8000 grains of 0.003 m" in done.stdout
    return folder


def test_the_packing_is_where_it_was(imported):
    rows = np.array((imported / "packing.data").read_text().split("Atoms # sphere")[1].split(), dtype=float).reshape(-1, 7)
    assert np.allclose(rows[:, 4:], beads(), rtol=0, atol=1e-8)


def test_the_deck_drains(imported):
    """10 tau: 5,700 grains a second are 997 grains, of which a few per cent may be late or early."""
    done = subprocess.run([FRONT_END, "-in", "in.spot", "-log", "none"], cwd=imported, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    last = (imported / "drain.20.dump").read_text().splitlines()
    assert 900 < 8000 - int(last[3]) < 1100


def test_the_dry_run_knows_how_it_will_go(imported):
    """Numbers against a run: see test_dry_run.py."""
    done = command("check_deck.py", "in.spot", "-o", "check.png", "--lmp", FRONT_END, cwd=imported)
    assert done.returncode == 0 and done.stderr == "", done.stderr
    rows = {line[2:23].strip(): line[23:].split()[0] for line in done.stdout.splitlines()[1:-1]}
    assert rows["grains"] == "8000" and rows["narrowest outlet"] == "8" and "!" not in done.stdout
    assert (imported / "check.png").stat().st_size > 50000
