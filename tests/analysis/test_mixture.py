# SPDX-License-Identifier: GPL-2.0-or-later
"""What is measured of a mixture of two sizes, on flows that are known, and what its command says of input that does not fit."""

import json

import numpy as np
import pytest

from conftest import script
from spot_analysis.reading.frame import Frame
from spot_analysis.reading.scene import Scene
from spot_analysis.statistics import mixture
from spot_analysis.statistics.lacey import lacey_index
from spot_analysis.statistics.surface_share import surface_share
from synthetic import write_frames

SCENE = Scene(diameter=2.0, gravity=2.0, timestep=0.5, half_width_x=20.0, half_depth_y=8.0, orifice_radius=8.0)  # tau = 1
SMALL, LARGE = 0.8, 1.2  # radii


def falling_frames(small=0.5, large=0.5, times=range(0, 25, 2), count=6000, sort=False):
    """Frames of grains spread evenly over 20 d by 8 d by 30 d; those of a size fall at its speed, d/tau; gone below -2 d."""
    draws = np.random.default_rng(1)
    places = np.stack([draws.uniform(-10, 10, count), draws.uniform(-4, 4, count), draws.uniform(0, 30, count)], axis=1)
    is_large = places[:, 2] > 15 if sort else draws.random(count) < 0.25
    frames = []
    for time in times:
        now = places.copy()
        now[:, 2] -= np.where(is_large, large, small) * time
        there = now[:, 2] > -2
        frames.append(Frame(2 * time, 1 + np.flatnonzero(there), 2 * now[there], np.zeros((3, 2)),
                            {"radius": np.where(is_large, LARGE, SMALL)[there]}))
    return frames


def volume_of(*radii):
    return np.mean([(2 * radius / SCENE.diameter)**3 for radius in radii])


def test_a_plug_of_both_sizes():
    found = mixture.measure(falling_frames(), SCENE, 4, 24)
    # 6000 grains over 30 d leave at 0.5 d/tau: 100 a tau, each by its volume.
    mean = volume_of(SMALL, SMALL, SMALL, LARGE)
    assert found["outflow"][0] == pytest.approx(100 * mean, rel=0.05)
    assert found["large_share_left"][0] == pytest.approx(volume_of(LARGE) / 4 / mean, rel=0.05)
    for height in mixture.HEIGHTS:
        speeds = [value for name, value in found.items() if name.startswith(f"speed_{height:g}d")]
        assert len(speeds) == 5 and np.allclose([speed for speed, _ in speeds], 0.5)
        assert found[f"slower_large_{height:g}d"][0] == pytest.approx(0, abs=1e-9)
    assert found["packing_fraction"][0] == pytest.approx(6000 / (20 * 8 * 30) * np.pi / 6 * mean, rel=0.1)
    for size in "small", "large":
        assert found[f"residence_{size}_5d"][0] == pytest.approx(10.0, abs=1.1)


def test_large_grains_that_fall_slower():
    found = mixture.measure(falling_frames(small=0.5, large=0.25), SCENE, 4, 24)
    assert found["slower_large_10d"][0] == pytest.approx(0.25 / (0.75 * 0.5 + 0.25 * 0.25), rel=0.06)
    assert found["residence_small_5d"][0] == pytest.approx(10.0, abs=1.1)
    assert found["large_share_left"][0] == pytest.approx(volume_of(LARGE) / 2 / (3 * volume_of(SMALL) + volume_of(LARGE) / 2), rel=0.1)


def test_what_leaves_through_time():
    """Small grains lie below: large ones leave after 30 tau only."""
    found = mixture.measure(falling_frames(sort=True, times=range(0, 61, 2)), SCENE, 4, 60)
    shares = {int(name.rsplit("_", 1)[1][:-3]): value for name, (value, _) in found.items() if name.startswith("large_share_left_at")}
    assert all(share == 0 for time, share in shares.items() if time < 27)
    assert all(share == 1 for time, share in shares.items() if time > 33)
    assert len(shares) == 10


def test_laceys_index():
    """1 as by chance, 0 apart; an exact lattice of both is better than chance."""
    draws = np.random.default_rng(2)
    positions = draws.uniform(0, 16, (20000, 3))
    assert lacey_index(positions, draws.random(20000) < 0.3) == pytest.approx(1.0, abs=0.005)
    assert lacey_index(positions, positions[:, 2] > 8) == pytest.approx(0.0, abs=0.005)
    half = (positions[:, 2] > 8) ^ (draws.random(20000) < 0.25)  # shares of 1/4 and 3/4: (1/4 - 1/16) / (1/4)
    assert lacey_index(positions, half) == pytest.approx(0.75, abs=0.02)
    assert np.isnan(lacey_index(positions[:10], np.zeros(10, bool)))


def test_share_of_the_surface():
    """On a slope: a layer 3 d thick, of large grains to the right of the middle, lies on small ones."""
    x, depth = (values.ravel() for values in np.meshgrid(np.arange(-10, 10, 2.5) + 1.25, np.arange(0, 12, 1.0)))
    positions = np.stack([x, 0 * x, 20 + 0.5 * x - depth], axis=1)
    large = (depth < 3) & (x > 0)
    assert surface_share(positions, np.where(large, 3.0, 1.0), large) == pytest.approx(3 / 4)
    assert np.isnan(surface_share(positions[:0], large[:0], large[:0]))


def test_equal_grains():
    """What needs no second size is measured all the same."""
    equal = [Frame(f.timestep, f.ids, f.positions, f.box, {"radius": np.ones(len(f.ids))}) for f in falling_frames()]
    found = mixture.measure(equal, SCENE, 4, 24)
    assert found["outflow"][0] == pytest.approx(100, rel=0.1) and found["large_share_left"][0] == 0
    assert found["speed_10d_x5.0d"][0] == pytest.approx(0.5) and np.isnan(found["lacey_end"][0])


def test_input_that_does_not_fit():
    frames = falling_frames()
    with pytest.raises(ValueError, match="2 snapshots between 0 and 2 tau"):
        mixture.measure(frames, SCENE, 0, 2)
    with pytest.raises(ValueError, match="the first snapshot has no grains"):
        mixture.measure([Frame(0, *(values[:0] for values in (frames[0].ids, frames[0].positions)), frames[0].box,
                               {"radius": np.zeros(0)})], SCENE, 4, 24)
    with pytest.raises(ValueError, match="no column 'radius'"):
        mixture.measure([Frame(f.timestep, f.ids, f.positions, f.box) for f in frames], SCENE, 4, 24)


def write_run(folder):
    return write_frames(folder, falling_frames(count=900), SCENE.as_dict(), ("radius",))


def test_the_command_compares_and_keeps_statistics(tmp_path):
    run, kept = write_run(tmp_path / "run"), tmp_path / "kept.json"
    said = script("mixture.py", run, "--from", 4, "--to", 24, "-o", kept)
    assert said.returncode == 0 and "quantities" in said.stdout, said.stderr
    said = script("mixture.py", kept, run, run, "--from", 4, "--to", 24, "--plot", tmp_path / "profiles.png")
    assert said.returncode == 0, said.stderr
    assert (tmp_path / "profiles.png").read_bytes().startswith(b"\x89PNG")
    rows = [line.split("|")[1:-1] for line in said.stdout.splitlines()[2:] if line.startswith("|")]
    assert len(rows) > 15 and all(row[3].strip() in ("+0.0 %", "-0.0 %", "") for row in rows)
    said = script("mixture.py", kept, run, "--from", 6, "--to", 24)
    assert said.returncode == 1 and "holds the interval 4 to 24 tau" in said.stderr


def test_hopper_is_for_equal_grains(tmp_path):
    run = write_run(tmp_path / "run")
    scene = {"diameter": 2.0, "gravity": 2.0, "timestep": 0.5, "orifice_radius": 8.0, "cylinder_radius": 24.0, "cone_height": 20.0}
    (run / "scene.json").write_text(json.dumps(scene))
    said = script("hopper.py", run, "--from", 4, "--to", 24)
    assert said.returncode == 1 and "has radius 1.2" in said.stderr, said.stderr


def test_comparison_of_equal_grains_says_where_to_go(tmp_path):
    said = script("compare.py", write_run(tmp_path / "run"), tmp_path / "run", "-o", tmp_path / "out")
    assert said.returncode == 1 and "has radius" in said.stderr and "mixture.py" in said.stderr, said.stderr
