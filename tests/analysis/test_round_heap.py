# SPDX-License-Identifier: GPL-2.0-or-later
"""What is measured of a round container that drains to its end, on heaps whose angle is known."""

import math

import numpy as np
import pytest

from conftest import script
from spot_analysis.reading.axial_scene import AxialScene
from spot_analysis.reading.frame import Frame
from spot_analysis.statistics import round_heap
from synthetic import write_frames

FLAT = AxialScene(diameter=2.0, gravity=2.0, timestep=1.0, orifice_radius=8.0, cylinder_radius=24.0, cone_height=1e-15)  # tau = 1
CONE = AxialScene(diameter=2.0, gravity=2.0, timestep=1.0, orifice_radius=8.0, cylinder_radius=24.0, cone_height=6.0)


def heap(angle, scene=FLAT, seed=1, start=0.0):
    """Grains (n, 3) in d, spread evenly below a surface that rises outwards from the outlet's rim, at a packing fraction of 0.6."""
    rim, radius, base = round_heap.in_d(scene)
    draws = np.random.default_rng(seed)
    x, y = draws.uniform(-radius, radius, (2, 40000))
    z = draws.uniform(0, 17.0, 40000)
    r = np.hypot(x, y)
    over = (r - rim) * base / (radius - rim)
    inside = (r > rim) & (r < radius) & (z > over) & (z < start + (r - rim) * math.tan(math.radians(angle)))
    share = 0.6 / (math.pi / 6) * (2 * radius) ** 2 * 17.0 / 40000
    return np.stack([x, y, z], axis=1)[inside & (draws.random(40000) < share)]


@pytest.mark.parametrize("angle", [18, 23, 35])
def test_the_angle_of_a_heap_is_found(angle):
    found = [round_heap.heap_angle(*round_heap.surface(heap(angle, seed=seed), 12.0), FLAT) for seed in range(8)]
    assert np.mean([value for value, _ in found]) == pytest.approx(angle, abs=1.5)
    assert 0.2 < np.mean([error for _, error in found]) < 4


def test_the_angle_in_a_cone_is_with_the_horizontal():
    found = [round_heap.heap_angle(*round_heap.surface(heap(30, CONE, seed, start=2.0), 12.0), CONE)[0] for seed in range(8)]
    assert np.mean(found) == pytest.approx(30, abs=1.5)


def test_a_level_bed_has_a_level_surface():
    middles, heights = round_heap.surface(heap(0, seed=2, start=6.0), 12.0)
    assert middles[0] == 0.5 and middles[-1] == 11.5
    assert np.isnan(heights[:4]).all()  # over the outlet is nothing
    assert heights[5:] == pytest.approx(7 * [5.6], abs=0.5)  # highest centres lie below
    assert round_heap.heap_angle(middles, heights, FLAT)[0] == pytest.approx(0, abs=2)


def test_single_grains_are_no_heap():
    positions = heap(23)
    few = positions[positions[:, 2] < 0.6][::7]
    assert np.isnan(round_heap.heap_angle(*round_heap.surface(few, 12.0), FLAT)[0])
    assert np.isnan(round_heap.surface(np.empty((0, 3)), 12.0)[1]).all()


def test_when_the_flow_is_over():
    assert round_heap.over_after([0, 10, 20, 30], [1000, 500, 0, 0]) == pytest.approx(19.8)
    assert math.isnan(round_heap.over_after([0, 10], [7, 7]))


def draining(rate=100, stays=None, times=range(0, 62, 2)):
    """Frames in which 100 grains a tau leave, until only ``stays`` do."""
    stays = heap(23) if stays is None else stays
    leaving = np.tile([0.0, 0.0, 3.0], (2000, 1))
    frames = []
    for time in times:
        there = np.concatenate([leaving[min(rate * time, 2000):], stays + [0.001 * time, 0, 0]])
        ids = np.concatenate([10000 + np.arange(2000)[min(rate * time, 2000):], 1 + np.arange(len(stays))])
        order = np.argsort(ids)
        frames.append(Frame(time, ids[order], 2.0 * there[order], np.zeros((3, 2))))
    return frames


def test_what_stays_is_counted():
    found = round_heap.measure(draining(), FLAT, 4, 16)
    stays = len(heap(23))
    assert found["outflow"] == pytest.approx([100.0, 0.0])
    assert found["left_0tau"][0] == 2000 + stays and found["left_10tau"][0] == 1000 + stays
    assert found["left_end"][0] == found["left_40tau"][0] == stays
    assert found["over_after"][0] == pytest.approx(19.8)
    assert found["left_in_last_20tau"][0] == 0 and found["crept_in_last_20tau"][0] == pytest.approx(0.02)
    assert found["angle_end"][0] == pytest.approx(23, abs=5) == found["angle_40tau"][0]
    assert "angle_60tau" in found and "angle_60tau" not in round_heap.measure(draining(times=range(0, 52, 2)), FLAT, 4, 16)
    assert found["surface_end_r11.5d"][0] == pytest.approx(7.5 * math.tan(math.radians(23)), abs=0.8)


def test_a_container_that_runs_empty_has_no_heap():
    found = round_heap.measure(draining(stays=np.empty((0, 3))), FLAT, 4, 16)
    assert found["left_end"][0] == 0 and math.isnan(found["angle_end"][0]) and math.isnan(found["crept_in_last_20tau"][0])


def test_too_short_a_drainage_is_refused():
    with pytest.raises(ValueError, match="ends at 10 tau, 40 are needed"):
        round_heap.measure(draining(times=range(0, 12, 2)), FLAT, 4, 40)


def test_the_command_compares_and_keeps_statistics(tmp_path):
    run, kept = write_frames(tmp_path / "run", draining(), {**vars(FLAT), "program": "test"}), tmp_path / "kept.json"
    said = script("round_heap.py", run, "--from", 4, "--to", 16, "-o", kept)
    assert said.returncode == 0 and "quantities" in said.stdout, said.stderr
    said = script("round_heap.py", kept, run, run, "--from", 4, "--to", 16, "--plot", tmp_path / "drainage.png")
    assert said.returncode == 0, said.stderr
    assert (tmp_path / "drainage.png").read_bytes().startswith(b"\x89PNG")
    [row] = [line for line in said.stdout.splitlines() if line.startswith("| left_end ")]
    assert row.endswith("| +0.0 % |")
