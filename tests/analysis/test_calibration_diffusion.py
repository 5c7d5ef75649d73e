# SPDX-License-Identifier: GPL-2.0-or-later
"""The mean flow that is taken out, and b_p of grains that are kicked by a known amount."""

import numpy as np
import pytest
from spot_analysis import calibration_diffusion as diffusion
from spot_analysis.calibration_estimate import CalibrationError
from spot_analysis.calibration_mean_flow import Fluctuations, take_out_mean_flow
from spot_analysis.calibration_tracks import Core, Tracks
from spot_analysis.container import Container

CORE = Core(8.0, 2.5, 25.0, 66.0)
DROP = 0.5  # d a step


def followed(rng, steps, grains, b_p, cage=0.0):
    """Fluctuations of grains inside the core for good: diffusion b_p and a rattle of variance ``cage`` about it."""
    middle = np.broadcast_to([0.0, 0.0, 40.0], (steps, grains, 3))
    rattle = rng.normal(0, np.sqrt(cage), (steps + 1, grains))
    residual = rng.normal(0, np.sqrt(2 * b_p * DROP), (steps, grains)) + np.diff(rattle, axis=0)
    return Fluctuations(middle, residual, np.full((steps, grains), DROP))


def fit(fluctuations, lags=10):
    steps = len(fluctuations.residual)
    return diffusion.fit_diffusion(41.0 + 2 * np.arange(steps), diffusion.lagged_sums(fluctuations, CORE, lags),
                                   (40.0, 40.0 + 2 * steps))


@pytest.mark.parametrize("cage", [0.0, 1e-3])
def test_known_diffusion_length(cage):
    """A cage adds a constant, not a slope."""
    found = fit(followed(np.random.default_rng(0), 26, 2000, 2.5e-3, cage))
    assert found.length.error < 1e-4
    assert found.length.value == pytest.approx(2.5e-3, abs=3 * found.length.error)
    assert found.line.value[1] == pytest.approx(2 * cage, abs=3 * found.line.error[1])
    assert found.drop[found.fitted].tolist() == [1, 1.5, 2, 2.5, 3, 3.5, 4, 4.5, 5]


def test_variance_against_the_obvious_way():
    """Of the sums of successive residuals, when every path is complete; edges of the interval count differently."""
    rng = np.random.default_rng(1)
    fluctuations = followed(rng, 400, 50, 2.5e-3, 1e-3)
    sums = diffusion.lagged_sums(fluctuations, CORE, 5).sum(axis=0)
    variance, drop = diffusion.variance_of_sums(sums)
    path = np.concatenate([np.zeros((1, 50)), np.cumsum(fluctuations.residual, axis=0)])
    for lag in range(1, 6):
        assert variance[lag - 1] == pytest.approx(((path[lag:] - path[:-lag])**2).mean(), rel=0.03)
    assert drop == pytest.approx(DROP)


def test_errors_cover_the_truth():
    """Paths overlap, blocks do not depend on each other: 2 SE should cover about 91 % (8 blocks); 4 deviations are 10 %."""
    rng = np.random.default_rng(2)
    found = [fit(followed(rng, 26, 60, 2.5e-3)).length for _ in range(150)]
    covered = np.mean([abs(one.value - 2.5e-3) < 2 * one.error for one in found])
    assert 0.79 < covered <= 1


def test_grains_that_leave_count_while_they_can_be_followed():
    fluctuations = followed(np.random.default_rng(0), 6, 4, 1e-3)
    fluctuations.residual[3:, 0] = np.nan
    sums = diffusion.lagged_sums(fluctuations, CORE, 3)
    assert sums[:, :, 2].tolist() == [[4, 4, 4], [4, 4, 3], [4, 3, 3], [3, 3, 3], [3, 3, 0], [3, 0, 0]]


def convergent(steps=20, grains=6000, noise=0.0, seed=0):
    """Tracks along the streamlines x ~ sqrt(z) of a free walk, each grain at its own speed, in silo and core of 2006."""
    rng = np.random.default_rng(seed)
    x, y, z = (rng.uniform(low, high, grains) for low, high in ((-14, 14), (-3.5, 3.5), (10, 80)))
    speed = rng.uniform(0.15, 0.35, grains)
    positions = [np.stack([x, y, z], axis=1)]
    for _ in range(steps):
        lower = z - 2 * speed
        x = x * np.sqrt(np.maximum(lower, 1) / z) + rng.normal(0, noise, grains)
        z = np.maximum(lower, 1)
        positions.append(np.stack([x, y, z], axis=1))
    return Tracks(Container(25.0, 4.0, 4.0), 40 + 2.0 * np.arange(steps + 1), np.array(positions), positions[0],
                  np.array([0.0]), [positions[0][:, 2]])


def test_converging_streamlines_leave_nothing():
    """They move a grain by up to 0.1 d a step; what is left must be below a per cent of a fluctuation's variance."""
    fluctuations = take_out_mean_flow(convergent(), CORE)
    inside = CORE.contains(fluctuations.middle)
    assert np.abs(fluctuations.residual[inside]).max() < 4e-3


def test_fluctuations_stay():
    """Even over 5 d, where a field of small bins would take out a part of them."""
    fluctuations = take_out_mean_flow(convergent(noise=0.05), CORE)
    inside = CORE.contains(fluctuations.middle)
    assert fluctuations.residual[inside].var() == pytest.approx(2.5e-3, rel=0.02)
    sums = diffusion.lagged_sums(fluctuations, CORE, 10).sum(axis=0)
    variance, drop = diffusion.variance_of_sums(sums)
    assert variance[9] == pytest.approx(10 * 2.5e-3, rel=0.05)


def test_too_little_drop_is_refused():
    tracks = convergent(steps=12)
    with pytest.raises(CalibrationError, match="b_p needs 7.5 d"):
        diffusion.measure_diffusion(tracks, take_out_mean_flow(tracks, CORE), CORE)


def test_too_much_drop_is_refused():
    fluctuations = followed(np.random.default_rng(0), 20, 100, 1e-3)
    fluctuations.drop[:] = 2.0
    with pytest.raises(CalibrationError, match="too far for the slope"):
        fit(fluctuations, lags=3)


def test_grains_that_do_not_diffuse_are_refused():
    fluctuations = followed(np.random.default_rng(0), 20, 100, 0.0, cage=1e-3)
    with pytest.raises(CalibrationError, match="does not grow with the drop"):
        fit(fluctuations)
