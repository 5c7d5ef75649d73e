# SPDX-License-Identifier: GPL-2.0-or-later
"""Grains that leave, and those that go round: counted by a column of the dumps, or seen by their jumps."""

import dataclasses
import json

import numpy as np
import pytest

from conftest import script
from spot_analysis.reading.axial_scene import AxialScene
from spot_analysis.reading.frame import Frame
from spot_analysis.reading.scene import Scene
from spot_analysis.statistics import axial_flow, box_flow, mixture
from spot_analysis.statistics.passages import drained, residence_times, snapshots_of
from synthetic import write_frames

# d = 2, tau = 1
HOPPER = AxialScene(diameter=2.0, gravity=2.0, timestep=0.5, orifice_radius=8.0, cylinder_radius=24.0, cone_height=20.0)
BOX = Scene(diameter=2.0, gravity=2.0, timestep=0.5, half_width_x=24.0, half_depth_y=24.0, orifice_radius=8.0)
SPEED = 0.5  # d/tau
HEIGHT = 40.0  # d


def round_frames(height=HEIGHT, counted=True, count=4000, times=range(0, 201, 2), speed=SPEED):
    """Frames of a bed of which each grain falls at one speed, and comes in again on top when it has left; 12 d around the axis."""
    draws = np.random.default_rng(1)
    radius, angle, start = 12 * np.sqrt(draws.random(count)), 2 * np.pi * draws.random(count), height * draws.random(count)
    frames = []
    for time in times:
        z, rounds = (start - speed * time) % height, -np.floor((start - speed * time) / height)
        extra = {"radius": np.ones(count), **({"f_bed[5]": rounds} if counted else {})}
        places = 2.0 * np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=1)
        frames.append(Frame(2 * time, np.arange(1, count + 1), places, np.zeros((3, 2)), extra))
    return frames


@pytest.mark.parametrize("counted", [True, False])
@pytest.mark.parametrize("measure, scene", [(axial_flow.measure, HOPPER), (box_flow.measure, BOX), (mixture.measure, BOX)])
def test_grains_that_go_round_leave_and_stay_as_others(measure, scene, counted):
    """All leave in 80 tau, so 4000 / 80 in a tau, and come from 5 d in 10 tau."""
    found = measure(round_frames(counted=counted), scene, 100, 200)
    assert found["outflow"][0] == pytest.approx(50, rel=0.03)
    residence = "residence_small_5d" if measure is mixture.measure else "residence_median_5d"
    assert found[residence][0] == pytest.approx(10.0, abs=1.0)
    speeds = [value for name, (value, _) in found.items() if name.startswith("speed_") and np.isfinite(value)]
    assert len(speeds) > 5 and speeds == pytest.approx(len(speeds) * [SPEED])


def test_a_column_counts_what_goes_round_more_than_once():
    frames = round_frames(times=range(0, 401, 100))
    found = axial_flow.measure(frames, HOPPER, 0, 400)
    assert found["outflow"][0] == pytest.approx(50, rel=0.01)
    with pytest.raises(ValueError, match="of 4000 grains go round between 0 and 100 tau, too many to tell how often each"):
        axial_flow.measure(round_frames(times=range(0, 401, 100), counted=False), HOPPER, 0, 400)


@pytest.mark.parametrize("measure, scene", [(axial_flow.measure, HOPPER), (box_flow.measure, BOX), (mixture.measure, BOX)])
def test_what_the_dumps_do_not_tell_is_said(measure, scene):
    """In a bed of 4 d grains come in so low that their jumps are none."""
    frames = round_frames(height=4.0, counted=False, times=range(0, 25))
    with pytest.raises(ValueError, match="no grain leaves, but grains come down by .* the dumps do not tell which go round"):
        measure(frames, scene, 4, 24)
    assert measure(round_frames(height=4.0, times=range(0, 25)), scene, 4, 24)["outflow"][0] == pytest.approx(500, rel=0.03)


@pytest.mark.parametrize("counted", [True, False])
def test_one_grain(counted):
    """It is seen below the outlet before it comes in again, and then is gone for good."""
    heights, rounds = (6.0, 2.0, -1.0, 20.0, 3.0, None), (0, 0, 0, 1, 1, None)
    frames = [Frame(2 * k, np.array([7] if z is not None else [], int), np.array([[0, 0, 2 * z]] if z is not None else np.empty((0, 3))),
                    np.zeros((3, 2)), {"f_bed[5]": np.array([turn] if z is not None else [])} if counted else {})
              for k, (z, turn) in enumerate(zip(heights, rounds))]
    # a frame with more grains, or one of one would be too many; they rest
    rest = np.stack([np.zeros(9), np.zeros(9), np.full(9, 30.0)], axis=1)
    frames = [dataclasses.replace(frame, ids=np.append(frame.ids, 10 + np.arange(9)), positions=np.vstack([frame.positions, rest]),
                                  extra={name: np.append(values, np.zeros(9)) for name, values in frame.extra.items()})
              for frame in frames]
    snapshots = snapshots_of(frames, HOPPER)
    assert [int(drained(*pair).sum()) for pair in zip(snapshots, snapshots[1:])] == [0, 1, 0, 0, 1]
    stays = [float(time) for _, _, _, times in residence_times(snapshots, 5.0) for time in times]
    # From 5 d, reached at 0.25 tau, to 1.5 tau; and from 3 + 15/17 tau to 4.5 tau.
    assert stays == pytest.approx([1.25, 4.5 - 3 - 15 / 17])


def test_other_columns_are_no_counts():
    """Jumps are looked for then."""
    frames = [dataclasses.replace(frame, extra={"f_other[5]": np.full(4000, 0.5)}) for frame in round_frames(counted=False)]
    assert axial_flow.measure(frames, HOPPER, 100, 200)["outflow"][0] == pytest.approx(50, rel=0.03)


def test_the_command_reads_the_column(tmp_path):
    halves = round_frames(times=range(0, 25, 4), count=1000, speed=5.0)  # half of them between two frames
    write_frames(tmp_path, halves, vars(HOPPER), ("f_bed[5]",))
    said = script("hopper.py", tmp_path, "--from", 4, "--to", 24, "-o", tmp_path / "found.json")
    assert said.returncode == 0, said.stderr
    assert json.loads((tmp_path / "found.json").read_text())["quantities"]["outflow"][0] == pytest.approx(125, rel=0.03)
