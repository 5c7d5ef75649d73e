# SPDX-License-Identifier: GPL-2.0-or-later
"""What is measured of a bed that is turned over, on flows that are known, and what its command says of runs that do not fit."""

import json

import numpy as np
import pytest

from conftest import script
from spot_analysis.reading.axial_scene import AxialScene
from spot_analysis.reading.frame import Frame
from spot_analysis.statistics import turnovers
from synthetic import write_frames

SCENE = AxialScene(diameter=2.0, gravity=2.0, timestep=0.5, orifice_radius=8.0, cylinder_radius=24.0, cone_height=10.0)  # tau = 1
HEIGHT, SPEED, SLOW = 30.0, 0.5, 0.3  # d, d/tau of grains inside of and beyond 6 d


def going_round(times=range(0, 301, 2), count=3000, still=0):
    """Frames of grains in a bed 30 d high that fall at one speed inside of 6 d from the axis and at another beyond, and begin
    again on top of it; some stand still."""
    draws = np.random.default_rng(1)
    radius, angle, height = 12 * np.sqrt(draws.random(count)), 2 * np.pi * draws.random(count), HEIGHT * draws.random(count)
    speed = np.where(radius < 6, SPEED, SLOW)
    speed[:still] = 0
    frames = []
    for time in times:
        z = np.mod(height - speed * time - 1e-9, HEIGHT)
        places = 2.0 * np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=1)
        frames.append(Frame(2 * time, np.arange(1, count + 1), places, np.zeros((3, 2))))
    return frames


def test_a_bed_that_falls_at_two_speeds():
    found = turnovers.measure(going_round(), SCENE, 1.0, 3.0)
    # A quarter of the grains takes 60 tau, the others 100.
    turnover = 1 / (0.25 * SPEED / HEIGHT + 0.75 * SLOW / HEIGHT)
    assert found["turnover"][0] == pytest.approx(turnover, rel=0.02)
    assert found["fall_16d_r1.0d"][0] == pytest.approx(SPEED * turnover, rel=0.02)
    assert found["fall_16d_r9.0d"][0] == pytest.approx(SLOW * turnover, rel=0.02)
    # Of all stays 0.25 / 60 over (0.25 / 60 + 0.75 / 100) are short: 36 %.
    assert found["residence_p05"][0] == pytest.approx(60 / turnover, rel=0.05)
    assert found["residence_median"][0] == pytest.approx(100 / turnover, rel=0.05)
    density = {float(name.rsplit("_", 1)[1]): value[0] for name, value in found.items() if name.startswith("residence_density")}
    assert 0.1 * sum(density.values()) == pytest.approx(1.0)
    assert 0.1 * (density[0.65] + density[0.75]) == pytest.approx(0.36, abs=0.03)
    assert found["residence_longer"][0] == found["never_drained"][0] == 0


def test_grains_that_never_drain_are_counted():
    found = turnovers.measure(going_round(times=range(0, 401, 2), still=300), SCENE, 1.0, 3.0)
    assert found["never_drained"][0] == pytest.approx(0.1)


def test_long_stays_are_not_told_shorter_than_they_are():
    """Two in five fall so slowly that they take more than two turnovers: that quantile is unknown."""
    frames = going_round(times=range(0, 601, 2))
    slow = np.random.default_rng(2).random(3000) < 0.4
    start = frames[0].positions[slow, 2] / 2.0
    for frame in frames:
        frame.positions[slow, 2] = 2.0 * np.mod(start - 0.05 * frame.timestep / 2, HEIGHT)
    found = turnovers.measure(frames, SCENE, 1.0, 3.0)
    assert found["residence_longer"][0] > 0.05 and np.isfinite(found["residence_p05"][0])
    assert found["never_drained"][0] > 0.05
    known = [found[f"residence_{name}"][0] for name in turnovers.SHARES if np.isfinite(found[f"residence_{name}"][0])]
    assert max(known) < turnovers.LONGEST


@pytest.mark.parametrize("start, end, said", [
    (1.0, 9.0, "turnovers, but --to is 9"),
    (0.5, 1.5, "--to is 1.5, but stays are followed for 2 turnovers"),
    (2.99, 3.0, "snapshots between 2.99 and 3 turnovers, at least 3")])
def test_runs_that_do_not_suffice(start, end, said):
    with pytest.raises(ValueError, match=said):
        turnovers.measure(going_round(), SCENE, start, end)


def test_grains_that_leave_for_good_are_refused():
    frames = going_round()
    frames[-1] = Frame(frames[-1].timestep, frames[-1].ids[1:], frames[-1].positions[1:], frames[-1].box)
    with pytest.raises(ValueError, match="grains leave for good"):
        turnovers.measure(frames, SCENE, 1.0, 3.0)


def test_the_command_compares_and_keeps_statistics(tmp_path):
    run = write_frames(tmp_path / "run", going_round(count=400), {**vars(SCENE), "program": "test"})
    kept = tmp_path / "kept.json"
    said = script("turnovers.py", run, "-o", kept)
    assert said.returncode == 0 and "| 1 to 3 turnovers |" in said.stdout, said.stderr
    said = script("turnovers.py", kept, run, run, "--plot", tmp_path / "bed.png")
    assert said.returncode == 0 and "+0.0 %" in said.stdout, said.stderr
    assert (tmp_path / "bed.png").read_bytes().startswith(b"\x89PNG")
    assert json.loads(kept.read_text())["interval"] == [1.0, 3.0]
    assert script("summary.py", kept, run).stdout == script("turnovers.py", kept, run).stdout
    said = script("turnovers.py", run, "--to", 5)
    assert said.returncode == 1 and said.stderr.startswith(f"error: {run}: "), said.stderr
