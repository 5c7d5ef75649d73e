# SPDX-License-Identifier: GPL-2.0-or-later
"""What is measured of a box with one or several outlets, on flows that are known."""

import dataclasses
import json

import numpy as np
import pytest

from conftest import script
from spot_analysis.base.errors import SceneError
from spot_analysis.reading.frame import Frame
from spot_analysis.reading.scene import Scene, scene_of
from spot_analysis.statistics import box_flow
from synthetic import write_frames

# d = 2, tau = 1
ONE = Scene(diameter=2.0, gravity=2.0, timestep=0.5, half_width_x=40.0, half_depth_y=8.0, orifice_radius=8.0)
SCENE = dataclasses.replace(ONE, orifices=2)


def falling_frames(speed_at, times=range(0, 13), count=6000):
    """Frames of grains spread evenly over 40 d by 8 d by 30 d, each of which falls at speed_at(x), d/tau; gone below -2 d."""
    x, y, height = (np.random.default_rng(1).random((3, count)).T * (40, 8, 30) - (20, 4, 0)).T
    frames = []
    for time in times:
        z = height - speed_at(x) * time
        there = z > -2
        frames.append(Frame(2 * time, 1 + np.flatnonzero(there), 2.0 * np.stack([x, y, z], axis=1)[there], np.zeros((3, 2))))
    return frames


def test_outlets_are_told_apart():
    """Grains fall on the right only."""
    frames = falling_frames(lambda x: 0.5 * (x > 0))
    found = box_flow.measure(frames, SCENE, 2, 12)
    assert found["outflow_at_x-10d"][0] == 0
    assert found["outflow_at_x10d"] == found["outflow"]
    height, right = frames[0].positions[:, 2] / 2, frames[0].positions[:, 0] > 0
    assert found["outflow"][0] == np.count_nonzero(right & (height > 1) & (height <= 6)) / 10 > 40
    assert found["speed_10d_x-9.0d"][0] == 0 and found["speed_10d_x9.0d"][0] == pytest.approx(0.5)
    # All of the left, of a bed that is 30 d high, and 29 d on the right at the beginning.
    assert found["still_share"][0] == pytest.approx(30 / 59, rel=0.05)
    # 6000 grains of pi/6 in 40 d by 8 d by 30 d.
    assert found["packing_fraction"][0] == pytest.approx(np.pi / 6 * 6000 / 9600, rel=0.1)
    # From 5 d at 0.5 d/tau, and snapshots 1 tau apart.
    assert found["residence_median_5d"][0] == pytest.approx(10.0, abs=0.6)


def test_a_ridge_is_as_high_as_what_stands_still():
    frames = falling_frames(lambda x: 0 * x)
    for frame in frames:  # what is above 7 d falls, through all below
        frame.positions[:, 2] -= frame.timestep / 2 * (frame.positions[:, 2] > 14.0)
    found = box_flow.measure(frames, SCENE, 0, 12)
    assert found["ridge_at_x0d"][0] == 7.0


def test_one_outlet_has_profiles_to_both_sides_and_no_ridge():
    found = box_flow.measure(falling_frames(lambda x: 0.4 - 0.01 * abs(x)), ONE, 0, 12)
    for place in (1.0, 9.0, 19.0):
        assert found[f"speed_15d_x{place:.1f}d"][0] == pytest.approx(0.4 - 0.01 * place, abs=0.005)
    assert not any(name.startswith(("ridge", "outflow_at")) or "x-" in name for name in found)


def test_too_short_an_interval_is_refused():
    with pytest.raises(ValueError, match="2 snapshots between 0 and 1 tau"):
        box_flow.measure(falling_frames(lambda x: 0 * x), SCENE, 0, 1)


def test_the_command_compares_and_keeps_statistics(tmp_path):
    run = write_frames(tmp_path / "run", falling_frames(lambda x: 0.5 * (x > 0), count=800), SCENE.as_dict())
    kept = tmp_path / "kept.json"
    options = ("--from", 2, "--to", 12)
    said = script("box.py", run, *options, "-o", kept)
    assert said.returncode == 0, said.stderr
    said = script("box.py", kept, run, run, *options, "--plot", tmp_path / "profiles.png")
    assert said.returncode == 0, said.stderr
    assert (tmp_path / "profiles.png").read_bytes().startswith(b"\x89PNG")
    rows = [line.split("|")[1:-1] for line in said.stdout.splitlines()[2:] if line.startswith("|")]
    assert len(rows) == len(json.loads(kept.read_text())["quantities"])
    assert all(row[3].strip() in ("+0.0 %", "-0.0 %", "") for row in rows)


def test_other_scripts_refuse_more_than_one_round_orifice(tmp_path):
    for change in ({"orifices": 2}, {"slot": True}):
        tmp_path.joinpath("scene.json").write_text(json.dumps(dataclasses.replace(ONE, **change).as_dict()))
        said = script("measure.py", tmp_path, "-o", tmp_path / "statistics.npz")
        assert said.returncode == 1 and "one round orifice" in said.stderr


@pytest.mark.parametrize("values, said", [({"orifices": 0}, "'orifices' must be a whole number from 1 on, not 0"),
                                          ({"orifices": 1.5}, "'orifices' must be"), ({"slot": 1}, "'slot' must be true or false")])
def test_scenes_that_do_not_fit_are_named(values, said):
    with pytest.raises(SceneError, match=said):
        scene_of({**ONE.as_dict(), **values})
