# SPDX-License-Identifier: GPL-2.0-or-later
"""Fits of many curves at once, and errors that go through formulas."""

import numpy as np
import pytest
from spot_analysis.calibration.estimate import CalibrationError, Estimate, combine, estimate
from spot_analysis.calibration.fits import fit_family
from spot_analysis.statistics.fits import fit_line

X = np.linspace(0, 4, 30)
RATES = np.arange(0.1, 3, 0.05)
CURVES = np.exp(-X * RATES[:, None])


def ratio(sums):
    return sums[..., 0] / sums[..., 1]


@pytest.mark.parametrize("rate", [0.31, 1.0, 1.777])
def test_family_finds_parameter_and_amplitude(rate):
    found, amplitude = fit_family(np.stack([0.6 * np.exp(-rate * X), 2.5 * np.exp(-rate * X)]), CURVES, RATES)
    np.testing.assert_allclose(found, rate, atol=2e-3)
    np.testing.assert_allclose(amplitude, [0.6, 2.5], rtol=0.05)  # that of the nearest curve of the table


def test_family_knows_nothing_beyond_its_table():
    values = np.stack([np.exp(-8 * X), np.exp(0.5 * X), -np.exp(-X), np.exp(-X)])
    assert np.isfinite(fit_family(values, CURVES, RATES)[0]).tolist() == [False, False, False, True]


def test_lines():
    slope, intercept = fit_line([1, 2, 4], [[3, 5, 9], [0, 0, 0]])
    np.testing.assert_allclose(slope, [2, 0], atol=1e-12)
    np.testing.assert_allclose(intercept, [1, 0], atol=1e-12)


def test_what_estimates_share_cancels():
    """Two counts with the same noise: their quotient has none."""
    times = np.arange(40, 92, 2.0)
    noise = 1 + 0.1 * np.random.default_rng(0).normal(size=len(times))
    one, other = (estimate(times, np.column_stack([scale * noise, np.ones(len(times))]), (40, 92), ratio) for scale in (70, 35))
    assert one.error == pytest.approx(2 * other.error) and one.error > 0.5
    quotient = combine(np.divide, one, other)
    assert quotient.value == pytest.approx(2) and quotient.error == pytest.approx(0, abs=1e-9)


def test_two_errors_of_a_quotient_cover_the_truth():
    """As test_bootstrap: 2 SE from 8 blocks cover about 91 %; 300 repeats, 4 standard deviations are 7 %."""
    rng = np.random.default_rng(5)
    times = np.arange(40, 92, 2.0)
    covered = 0
    for _ in range(300):
        parts = [estimate(times, np.column_stack([mean + rng.normal(size=len(times)), np.ones(len(times))]), (40, 92), ratio)
                 for mean in (20, 10)]
        quotient = combine(np.divide, *parts)
        covered += abs(quotient.value - 2) < 2 * quotient.error
    assert 0.80 < covered / 300 < 0.98


def test_too_few_blocks_are_refused():
    with pytest.raises(CalibrationError, match="only 3 blocks of 6 tau between 40 and 60 tau"):
        estimate([41, 48, 59], np.ones((3, 2)), (40, 60), ratio)


@pytest.mark.parametrize("value, scatter, determined", [
    (1.0, 0.1, True), (1.0, 0.5, False), (-1.0, 0.1, False), (np.nan, 0.1, False)])
def test_determined(value, scatter, determined):
    replicates = value + scatter * np.random.default_rng(0).normal(size=1000)
    assert Estimate(np.array(value), replicates).is_determined() == determined


def test_fits_that_often_fail_are_not_determined():
    replicates = np.where(np.arange(1000) < 50, np.nan, 1.0)
    assert not Estimate(np.array(1.0), replicates).is_determined()
