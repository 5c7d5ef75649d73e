# SPDX-License-Identifier: GPL-2.0-or-later
"""Counts, fluxes and profiles of motion that is known."""

import numpy as np
import pytest
from spot_analysis.statistics import flow, profile_width


def test_count_above_is_strict():
    counts = flow.count_above(np.array([0.0, 2.0, 1.0, 5.0]), np.array([-1, 0, 1, 4, 5]))
    np.testing.assert_array_equal(counts, [4, 3, 2, 1, 0])


def test_common_grains():
    first, second = flow.common_grains(np.array([1, 3, 5, 9]), np.array([3, 4, 9]))
    np.testing.assert_array_equal(first, [1, 3])
    np.testing.assert_array_equal(second, [0, 2])


@pytest.mark.parametrize("width", [3.0, 5.0])
def test_variance_of_a_gaussian_profile(width):
    """A profile that fits between the walls; sorting into bins of 1 d adds 1/12 d^2 (Sheppard). Sampled to 0.3 %."""
    rng = np.random.default_rng(3)
    start = rng.uniform([-25, -4, 5], [25, 4, 15], (400000, 3))
    speed = 0.5 * np.exp(-start[:, 0]**2 / (2 * width**2))
    end = start - np.outer(speed * 2.0, [0, 0, 1])
    edges = np.linspace(-25, 25, 51)
    counts, sums = flow.velocity_profile(start, end, 2.0, [10.0], edges)
    assert profile_width.moment_variance(counts, sums, edges)[0] == pytest.approx(width**2 + 1 / 12, rel=0.01)
    assert (sums / counts)[0, 25] == pytest.approx(0.5 * np.exp(-0.125 / width**2), rel=0.02)


def test_only_grains_of_the_slice_count():
    start = np.array([[0.2, 0, 10.9], [0.2, 0, 12.2], [3.2, 0, 9.5]])
    end = start - [0, 0, 0.4]
    counts, sums = flow.velocity_profile(start, end, 2.0, [10.0], np.arange(-5, 6.0))
    assert counts.sum() == 2 and counts[0, 5] == 1 and counts[0, 8] == 1
    assert sums[0, 5] == pytest.approx(0.2)


def test_variance_is_unknown_where_a_bin_is_empty():
    counts = np.array([1, 1, 0, 1, 1])
    assert np.isnan(profile_width.moment_variance(counts, 1.0 * counts, np.arange(6.0) - 2.5))
