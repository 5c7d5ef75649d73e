# SPDX-License-Identifier: GPL-2.0-or-later
"""Standard errors by block bootstrap."""

import numpy as np
import pytest
from spot_analysis.statistics.bootstrap import block_sums, bootstrap_error


def mean(sums):
    return sums[..., 0] / sums[..., 1]


def test_blocks_are_at_least_6_tau_long():
    times = np.arange(40, 92, 2.0)
    sums = block_sums(times, np.ones((len(times), 1)), (40, 92))
    assert len(sums) == 8 and sums.sum() == 26 and sums.min() >= 3


def test_gaps_leave_blocks_out():
    times = np.array([0.0, 2, 4, 30, 32, 34, 60])
    sums = block_sums(times, np.column_stack([times, np.ones(7)]), (0, 60))
    assert len(sums) == 3 and sums[:, 1].tolist() == [3, 3, 1]


def test_no_error_without_four_blocks():
    assert bootstrap_error(np.ones((3, 2)), mean) is None


def test_same_samples_same_error():
    sums = np.random.default_rng(0).random((8, 2))
    assert bootstrap_error(sums, mean) == bootstrap_error(sums, mean)


@pytest.mark.parametrize("correlation", [0.0, 0.3])
def test_two_standard_errors_cover_the_truth(correlation):
    """Mean of 52 tau of autoregressive noise, one sample in 2 tau, 8 blocks: 2 SE should cover it in about 91 % (t
    distribution, 7 degrees of freedom), somewhat less with correlation. 400 repeats: 4 standard deviations are 6 %."""
    rng = np.random.default_rng(11)
    times = np.arange(40, 92, 2.0)
    covered = 0
    for _ in range(400):
        noise = rng.normal(size=len(times) + 20)
        for step in range(1, len(noise)):
            noise[step] += correlation * noise[step - 1]
        samples = np.column_stack([noise[20:], np.ones(len(times))])
        sums = block_sums(times, samples, (40, 92))
        covered += abs(mean(sums.sum(axis=0))) < 2 * bootstrap_error(sums, mean)
    assert 0.80 < covered / 400 < 0.97
