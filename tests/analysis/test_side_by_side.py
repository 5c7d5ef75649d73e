# SPDX-License-Identifier: GPL-2.0-or-later
"""side_by_side.py on plugs that fall: seeds judged by their mean, twins, an interval, statistics and dumps alike."""

import pytest

from conftest import script
from synthetic import write_plug_flow

TIMES = range(0, 10, 2)
SPAN = ("--from", 0, "--to", 8)


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """Plugs that fall by half a layer, a whole one and two in 2 tau."""
    folder = tmp_path_factory.mktemp("runs")
    return [write_plug_flow(folder / name, speed, TIMES) for name, speed in (("slow", 0.5), ("fast", 1.0), ("faster", 2.0))]


def outflow(done):
    assert done.returncode == 0, done.stderr
    return next(line for line in done.stdout.splitlines() if line.startswith("| outflow")).strip("| ").split(" | ")[2:]


def test_seeds_and_twins(runs, tmp_path):
    slow, fast, faster = runs
    stored = tmp_path / "fast.npz"
    assert script("measure.py", fast, "-o", stored).returncode == 0
    done = script("side_by_side.py", stored, f"two={slow},{fast}", f"one={faster}", *SPAN)
    assert done.stdout.splitlines()[:3] == ["early: 0 to 8 tau", "", "|  | bound | two | one |"]
    assert outflow(done) == ["60 +- 20 / 80 yes", "160 / 80 **NO**"]
    assert outflow(script("side_by_side.py", f"{stored},{faster}", f"one={faster}", *SPAN)) == ["160 / 120 +- 40 yes"]


def test_interval(runs):
    whole, part = (script("side_by_side.py", runs[1], f"faster={runs[2]}", *words) for words in (SPAN, ("--from", 2, "--to", 6)))
    assert outflow(whole) == outflow(part)
    assert whole.stdout != part.stdout


def test_runs_that_are_too_short(runs):
    done = script("side_by_side.py", runs[1], f"faster={runs[2]}")
    assert done.returncode == 0 and done.stdout.startswith("the runs are too short for any interval of steady flow\n")
    assert "faster: outflow, early" in done.stderr and "(the runs do not reach it)" in done.stderr


@pytest.mark.parametrize("column", ["name", "=run", "name="])
def test_columns_without_runs(runs, column):
    done = script("side_by_side.py", runs[0], column)
    assert done.returncode == 1 and done.stderr.strip().endswith(f"error: '{column}' is not NAME=RUN,RUN...")
