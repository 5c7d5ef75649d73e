# SPDX-License-Identifier: GPL-2.0-or-later
"""Lines on progress: on a terminal only, and with the time that is left."""

import io
import sys

import pytest

from conftest import script
from synthetic import write_plug_flow

from spot_analysis.base import progress


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.fixture
def clock(monkeypatch):
    """A list of one time, s."""
    now = [100.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    return now


def test_a_terminal_is_told_how_long_it_takes(monkeypatch, clock):
    monkeypatch.setattr(sys, "stderr", Terminal())
    lines = progress.Progress("DEM")
    for seconds, done in ((2, 1), (10, 5), (12, 6), (20, 10)):
        clock[0] = 100 + seconds
        lines(f"{done} snapshots", progress.share_of(done, 40))
    clock[0] = 130
    lines("one file", progress.share_of(3, 1))
    lines.finish("all")
    assert sys.stderr.getvalue().splitlines() == [
        "DEM: 5 snapshots, about 70 s left (10 s)", "DEM: 10 snapshots, about 60 s left (20 s)", "DEM: one file (30 s)", "DEM: all (30 s)"]


def test_items_are_counted(monkeypatch, clock):
    monkeypatch.setattr(sys, "stderr", Terminal())

    def work():
        for item in "ab":
            clock[0] += 30
            yield item

    assert list(progress.counted(work(), 3, "runs")) == ["a", "b"]
    assert sys.stderr.getvalue() == "runs: 1 of 3 done, about 60 s left (30 s)\nruns: 2 of 3 done, about 30 s left (60 s)\n"


def test_a_file_gets_nothing(monkeypatch, clock, tmp_path):
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    lines = progress.Progress("DEM")
    clock[0] += 60
    lines("half", 0.5)
    lines.finish("all")
    assert sys.stderr.getvalue() == ""
    done = script("measure.py", write_plug_flow(tmp_path / "slow", 0.5, range(0, 10, 2)), "-o", tmp_path / "a.npz")
    assert done.returncode == 0 and not [line for line in done.stderr.splitlines() if not line.startswith("warning: ")]
