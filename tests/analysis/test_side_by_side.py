# SPDX-License-Identifier: GPL-2.0-or-later
"""side_by_side.py on plugs that fall: means over runs, an interval, statistics and dumps alike."""

import pytest

from conftest import script
from synthetic import write_plug_flow

TIMES = range(0, 10, 2)


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """Plugs that fall by half a layer, a whole one and two in 2 tau."""
    folder = tmp_path_factory.mktemp("runs")
    return [write_plug_flow(folder / name, speed, TIMES) for name, speed in (("slow", 0.5), ("fast", 1.0), ("faster", 2.0))]


def outflow(done):
    assert done.returncode == 0, done.stderr
    return next(line for line in done.stdout.splitlines() if line.startswith("| outflow"))


def test_means_and_spread(runs, tmp_path):
    slow, fast, faster = runs
    stored = tmp_path / "fast.npz"
    assert script("measure.py", fast, "-o", stored).returncode == 0
    done = script("side_by_side.py", stored, f"two={slow},{fast}", f"one={faster}")
    assert done.stdout.splitlines()[0] == "| | DEM | two | one |"
    assert outflow(done) == "| outflow (1/tau) | 80 | 60 +- 28 | 160 |"


def test_interval(runs):
    whole, part = (script("side_by_side.py", runs[1], f"faster={runs[2]}", *words) for words in ((), ("--from", 2, "--to", 6)))
    assert outflow(whole) == outflow(part)
    assert whole.stdout != part.stdout


@pytest.mark.parametrize("column", ["name", "=run", "name="])
def test_columns_without_runs(runs, column):
    done = script("side_by_side.py", runs[0], column)
    assert done.returncode == 1 and done.stderr.strip().endswith(f"error: '{column}' is not NAME=RUN,RUN...")
