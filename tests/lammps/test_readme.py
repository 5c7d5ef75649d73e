# SPDX-License-Identifier: GPL-2.0-or-later
"""The deck that README shows is examples/own-hopper/in.own, and drains its hopper."""

import os
import re
import subprocess

from lammps_runs import FRONT_END, ROOT

HOPPER = ROOT / "examples" / "own-hopper"


def test_readme_shows_the_deck():
    shown = re.search(r"```\n(variable .*?)```", (ROOT / "README.md").read_text(), re.DOTALL).group(1)
    assert (HOPPER / "in.own").read_text() == "# SPDX-License-Identifier: GPL-2.0-or-later\n" + shown


def test_the_deck_drains(tmp_path):
    """20 steps of it, 10 tau: 5,700 grains a second are 997 grains, of which a few per cent may be late or early."""
    folder = tmp_path / "examples" / "own-hopper"
    folder.mkdir(parents=True)
    os.symlink(ROOT / "lammps-package", tmp_path / "lammps-package")
    os.symlink(HOPPER / "packing.data.gz", folder / "packing.data.gz")
    (folder / "in.own").write_text((HOPPER / "in.own").read_text().replace("run       160", "run       20"))
    done = subprocess.run([FRONT_END, "-in", "in.own", "-log", "none"], cwd=folder, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    last = (folder / "drain.20.dump").read_text().splitlines()
    assert 900 < 8000 - int(last[3]) < 1100
    assert last[8].split() == "ITEM: ATOMS id x y z radius vx vy vz".split()
