# SPDX-License-Identifier: GPL-2.0-or-later
"""The baselines: a packing that stays, and a flow that closes its volume and spreads as it should."""

import json

import baseline
import numpy as np
import pytest
from spot_analysis.reading.dump import read_frames

from conftest import script
from synthetic import frame_text, write_text

SCENE = {"diameter": 0.01, "gravity": 1.0, "timestep": 0.01, "half_width_x": 0.25, "half_depth_y": 0.04, "orifice_radius": 0.04}


def test_kinematic_flow_closes_its_volume():
    """Divergence by differences over 1e-4 d; flux through any height; variance 2 b z + start."""
    rng = np.random.default_rng(0)
    places, step = rng.uniform([-15, -4, 1], [15, 4, 80], (500, 3)), 1e-4

    def velocity(points):
        return baseline.kinematic_velocity(points, 15.0, 1.15, 2.0)

    divergence = sum((velocity(places + step * axis) - velocity(places - step * axis))[:, k] / (2 * step)
                     for k, axis in enumerate(np.eye(3)))
    np.testing.assert_allclose(divergence, 0, atol=1e-7)
    x = np.linspace(-120, 120, 20001)
    for z in (0.0, 30.0):
        down = -velocity(np.column_stack([x, 0 * x, 0 * x + z]))[:, 2]
        assert down.sum() * (x[1] - x[0]) == pytest.approx(15, rel=1e-6)
        assert (down * x**2).sum() / down.sum() == pytest.approx(2.0 + 2.3 * z, rel=1e-6)


@pytest.fixture
def packing(tmp_path):
    points = np.random.default_rng(1).uniform([-0.25, -0.04, 0], [0.25, 0.04, 0.9], (32000, 3))
    (tmp_path / "scene.json").write_text(json.dumps(SCENE))
    return write_text(tmp_path / "packing.dump", frame_text(0, np.arange(1, 32001), points))


def frames(packing, folder, model):
    done = script("baseline.py", model, packing, "-o", folder, "--time", 10)
    assert done.returncode == 0, done.stderr
    return list(read_frames(str(folder)))


def test_nothing_changes(packing, tmp_path):
    found = frames(packing, tmp_path / "out", "nothing")
    assert [frame.timestep for frame in found] == [20000 * number for number in range(6)]
    start = next(read_frames(packing))
    for frame in found:
        np.testing.assert_allclose(frame.positions, start.positions / 0.01, rtol=1e-8)


def test_outflow_of_the_kinematic_model(packing, tmp_path):
    """69.6 grains a tau, of which Poisson statistics make 696 +- 26 in 10 tau; three deviations."""
    found = frames(packing, tmp_path / "out", "kinematic")
    above = [(frame.positions[:, 2] > 0).sum() for frame in found]
    assert above[0] - above[-1] == pytest.approx(696, abs=80)


@pytest.mark.parametrize("option", ["--time", "--outflow", "--diffusion", "--start"])
@pytest.mark.parametrize("value", ["0", "-1", "nan", "inf"])
def test_bad_number(packing, tmp_path, option, value):
    done = script("baseline.py", "kinematic", packing, "-o", tmp_path / "out", f"{option}={value}")
    assert done.returncode == 1
    assert done.stderr == f"error: {option} is {float(value):g} but must be positive and finite\n"
    assert not (tmp_path / "out").exists()
