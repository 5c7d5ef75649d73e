# SPDX-License-Identifier: GPL-2.0-or-later
"""The packing fraction that pouring_study.py measures, on a packing of known density; its words of refusal."""

import itertools
import math
import subprocess
import sys

import pytest

from liggghts_runs import DECKS, DIAMETER


def study(*words):
    return subprocess.run([sys.executable, DECKS / "silo" / "pouring_study.py", *map(str, words)], capture_output=True, text=True)


@pytest.mark.parametrize("shift", [0, 0.3, 0.9])
def test_packing_fraction_of_a_cubic_lattice(shift, tmp_path):
    """Spheres cut by the slab's faces count with the part inside, so the lattice's height does not matter."""
    dump = tmp_path / "1_20_15485863_2" / "pour" / "packed.dump"
    dump.parent.mkdir(parents=True)
    places = itertools.product(range(16), range(8), range(27))
    rows = [f"{i} 1 {(x - 7.5) * DIAMETER} {(y - 3.5) * DIAMETER} {(z + 0.5 + shift) * DIAMETER} {DIAMETER / 2} 0 0 0"
            for i, (x, y, z) in enumerate(places, 1)]
    dump.write_text("\n".join(["header"] * 9 + rows) + "\n")
    done = study("--out", tmp_path, "1:20")
    assert done.returncode == 0, done.stderr
    assert float(done.stdout.splitlines()[1].split()[4]) == pytest.approx(math.pi / 6, abs=1e-4)


@pytest.mark.parametrize("case, message", [("fast", "'fast' is not FLUX:SPEED"), ("1", "'1' is not FLUX:SPEED"),
                                           ("1:5", "the fall alone gives 7.2 sqrt(g d), more than the 5 of '1:5'")])
def test_bad_case(case, message, tmp_path):
    done = study("--out", tmp_path, case)
    assert done.returncode != 0
    assert message in done.stderr
