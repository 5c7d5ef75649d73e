# SPDX-License-Identifier: GPL-2.0-or-later
"""b_s from v_z profiles that spots of known diffusion length make between walls."""

import numpy as np
import pytest
from spot_analysis import calibration_spreading as spreading
from spot_analysis.calibration_estimate import CalibrationError
from spot_analysis.container import Container

CONTAINER = Container(25.0, 4.0, 4.0)
EDGES = spreading.profile_edges(CONTAINER, 1.0)
SPAN = (40.0, 64.0)
TIMES = np.arange(41.0, 64.0, 2.0)


def walks(rng, b_s, number):
    """x of walkers with diffusion length b_s at each of HEIGHTS, reflected at +-24 d, (H, number)."""
    rise = 0.25
    x = rng.uniform(-1.4, 1.4, number)
    places = []
    for height in np.arange(rise, spreading.HEIGHTS[-1] + rise / 2, rise):
        x = x + rng.normal(0, np.sqrt(2 * b_s * rise), number)
        x = np.where(np.abs(x) > 24, np.sign(x) * 48 - x, x)
        if np.isclose(height, spreading.HEIGHTS).any():
            places.append(x)
    return np.array(places)


def sums_of_walks(rng, b_s, number=5000, radius=2.6):
    """``profile_sums`` as if each bin held 100 grains, moved by spots anywhere within ``radius``."""
    places = walks(rng, b_s, number)
    # x of a point evenly in a sphere
    points = rng.normal(size=(number, 3))
    offset = radius * rng.uniform(size=number)**(1 / 3) * (points / np.linalg.norm(points, axis=1)[:, None])[:, 0]
    profiles = np.array([np.histogram(x + offset, EDGES)[0] for x in places]) / 250
    return np.concatenate([np.full(profiles.size, 100.0), 100 * profiles.ravel()])


@pytest.mark.parametrize("b_s, method", [(0.8, "walled_moment"), (1.25, "walled_gaussian"), (2.0, "walled_moment")])
def test_known_diffusion_length(b_s, method):
    rng = np.random.default_rng(3)
    samples = np.array([sums_of_walks(rng, b_s) for _ in TIMES])
    found = spreading.fit_spreading(TIMES, samples, SPAN, spreading.HEIGHTS, EDGES, CONTAINER, 2.6, 1.0, method)
    assert found.diffusion.error < 0.08
    assert found.diffusion.value == pytest.approx(b_s, abs=max(3 * found.diffusion.error, 0.01))
    assert found.lines[method].value[1] == pytest.approx(0.5, abs=2)  # a disc of 1.4 d: 2 d^2 / 4


def test_walls_hide_spreading_from_a_plain_moment():
    rng = np.random.default_rng(3)
    samples = np.array([sums_of_walks(rng, 1.25) for _ in TIMES])
    found = spreading.fit_spreading(TIMES, samples, SPAN, spreading.HEIGHTS, EDGES, CONTAINER, 2.6, 1.0, "walled_moment")
    assert found.lines["moment"].value[0] / 2 < 1.15 < 1.25 < found.lines["gaussian"].value[0] / 2


def test_sums_of_known_grains():
    middle = np.array([[0.5, 0, 10.0], [0.5, 0, 12.4], [0.5, 0, 12.6], [-23.5, 0, 15.0], [24.5, 0, 10]])
    sums = spreading.profile_sums(middle, np.array([0.4, 0.8, 9, 0.2, 9]), 2.0, [10.0, 15.0], EDGES).reshape(2, 2, 48)
    assert sums[0, 0].sum() == 2 and sums[0, 0, 24] == 2 and sums[1, 0, 24] == pytest.approx(0.6)
    assert sums[0, 1, 24] == 1 and sums[0, 1, 0] == 1 and sums[1, 1, 0] == pytest.approx(0.1)


def fit(profiles):
    """fit_spreading of steady profiles (H, X)."""
    row = np.concatenate([np.full(profiles.size, 100.0), 100 * profiles.ravel()])
    noise = 1 + 0.01 * np.random.default_rng(0).normal(size=(len(TIMES), len(row)))
    return spreading.fit_spreading(TIMES, row * noise, SPAN, spreading.HEIGHTS, EDGES, CONTAINER, 2.6, 1.0, "walled_moment")


def test_a_plug_is_refused():
    with pytest.raises(CalibrationError, match="does not widen"):
        fit(np.ones((len(spreading.HEIGHTS), 48)))


def test_an_empty_bin_is_refused():
    row = np.zeros(2 * len(spreading.HEIGHTS) * 48)
    with pytest.raises(CalibrationError, match="no grains somewhere in .x. < 24 d"):
        spreading.fit_spreading(TIMES, np.tile(row, (len(TIMES), 1)), SPAN, spreading.HEIGHTS, EDGES, CONTAINER, 2.6, 1.0,
                                "walled_moment")
