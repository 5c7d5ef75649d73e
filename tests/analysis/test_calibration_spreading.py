# SPDX-License-Identifier: GPL-2.0-or-later
"""b_s from v_z profiles that spots of known diffusion length make between walls."""

from types import SimpleNamespace

import numpy as np
import pytest
from spot_analysis.calibration import spreading
from spot_analysis.calibration.estimate import CalibrationError, estimate
from spot_analysis.reading.container import Container

CONTAINER = Container(25.0, 4.0, 4.0)
EDGES = np.linspace(-25, 25, 51)
HEIGHTS = np.arange(10.0, 41, 5)
SPAN = (40.0, 64.0)
TIMES = np.arange(41.0, 64.0, 2.0)


def walks(rng, b_s, number):
    """x of walkers with diffusion length b_s at each of HEIGHTS, reflected at +-24 d, (H, number)."""
    rise = 0.25
    x = rng.uniform(-1.4, 1.4, number)
    places = []
    for height in np.arange(rise, HEIGHTS[-1] + rise / 2, rise):
        x = x + rng.normal(0, np.sqrt(2 * b_s * rise), number)
        x = np.where(np.abs(x) > 24, np.sign(x) * 48 - x, x)
        if np.isclose(height, HEIGHTS).any():
            places.append(x)
    return np.array(places)


def sums_of_walks(rng, b_s, number=5000, radius=2.6):
    """Counts and sums as if each bin held 100 grains, moved by spots anywhere within ``radius``."""
    places = walks(rng, b_s, number)
    # x of a point evenly in a sphere
    points = rng.normal(size=(number, 3))
    offset = radius * rng.uniform(size=number)**(1 / 3) * (points / np.linalg.norm(points, axis=1)[:, None])[:, 0]
    profiles = np.array([np.histogram(x + offset, EDGES)[0] for x in places]) / 250
    return np.concatenate([np.full(profiles.size, 100.0), 100 * profiles.ravel()])


def fit(samples):
    return spreading.fit_spreading(lambda statistic: estimate(TIMES, samples, SPAN, statistic), HEIGHTS, EDGES, CONTAINER, 2.6,
                                   1.0)


@pytest.mark.parametrize("b_s", [0.8, 1.25, 2.0])
def test_known_diffusion_length(b_s):
    """Within three standard errors; the plain moment would give 1.1 d for 1.25 d."""
    rng = np.random.default_rng(3)
    found = fit(np.array([sums_of_walks(rng, b_s) for _ in TIMES]))
    assert found.diffusion.error < 0.08
    assert found.diffusion.value == pytest.approx(b_s, abs=max(3 * found.diffusion.error, 0.01))
    assert found.line.value[1] == pytest.approx(0.5, abs=2)  # a disc of 1.4 d: 2 d^2 / 4


def fit_steady(profiles):
    """The fit to steady profiles (H, X)."""
    row = np.concatenate([np.full(profiles.size, 100.0), 100 * profiles.ravel()])
    return fit(row * (1 + 0.01 * np.random.default_rng(0).normal(size=(len(TIMES), len(row)))))


def test_a_plug_is_refused():
    with pytest.raises(CalibrationError, match="does not widen"):
        fit_steady(np.ones((len(HEIGHTS), 50)))


def test_an_empty_bin_is_refused():
    with pytest.raises(CalibrationError, match="no grains somewhere in .x. < 24 d"):
        fit(np.zeros((len(TIMES), 2 * len(HEIGHTS) * 50)))


def view_of_profiles(variances, scatter=0.01):
    """A view whose v_z profiles are Gaussians with these variances, (P,), alike at all HEIGHTS, and what scatters."""
    x = (EDGES[1:] + EDGES[:-1]) / 2
    noise = 1 + scatter * np.random.default_rng(2).normal(size=(len(TIMES), 1, 1))
    speeds = np.exp(-x**2 / (2 * noise * np.asarray(variances)[:, None, None])) * np.ones((1, len(HEIGHTS), 1))
    run = SimpleNamespace(profile_heights=HEIGHTS, profile_edges=EDGES, profile_start=TIMES - 1, profile_end=TIMES + 1,
                          profile_counts=np.full(speeds.shape, 100.0), profile_sums=100 * speeds)
    return SimpleNamespace(run=run, interval=SimpleNamespace(span=SPAN), pair_rows=lambda start, end: np.arange(len(start)))


@pytest.mark.parametrize("growth, warned", [(0.0, False), (0.03, False), (0.12, True), (-0.12, True)])
def test_a_flow_that_gets_wider_is_told(growth, warned):
    early = TIMES < np.mean(SPAN)
    view = view_of_profiles(np.where(early, 40 * (1 - growth / 2), 40 * (1 + growth / 2)))
    found = spreading.measure_widening(view)
    assert found.value == pytest.approx(growth, abs=3 * found.error + 1e-3) and found.error < 0.02
    texts = []
    spreading.warn_of_widening(view, texts.append)
    assert len(texts) == warned
    assert not warned or f"change by {100 * float(found.value):+.0f} +-" in texts[0]
