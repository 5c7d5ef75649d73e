# SPDX-License-Identifier: GPL-2.0-or-later
"""Grains outside the container and overlaps with its walls."""

import numpy as np
import pytest
from spot_analysis.reading.container import Container
from spot_analysis.statistics.region import Region, structure_region

SILO = Container(25, 4, 4)


@pytest.mark.parametrize("position, outside", [
    ([0, 0, 10], False), ([24.9, 3.9, 0.1], False), ([25.1, 0, 10], True), ([0, -4.1, 10], True),
    ([3, 0, -5], False), ([5, 0, -5], False), ([10, 0, -5], True), ([6, 0, -0.1], True),
])
def test_outside(position, outside):
    assert SILO.outside(np.array([position]))[0] == outside


@pytest.mark.parametrize("position, overlap", [
    ([0, 0, 10], 0), ([24.6, 0, 10], 0.1), ([0, -3.7, 10], 0.2), ([10, 0, 0.3], 0.2), ([3.9, 0, 0.1], 0),
    ([24.6, 0, -3], 0),
])
def test_wall_overlap(position, overlap):
    assert SILO.wall_overlap(np.array([position]))[0] == pytest.approx(overlap)


def test_structure_region_is_the_papers():
    assert structure_region(SILO) == Region(15, 15, 45)


def test_region_is_covered_only_by_a_packing_that_goes_on_above():
    region = Region(5, 0, 10)
    grid = np.mgrid[-5:6, -3:4, 0:16].reshape(3, -1).T.astype(float)
    assert region.is_covered(grid, 5)
    assert not region.is_covered(grid[grid[:, 2] < 12], 5)
    assert not region.is_covered(np.empty((0, 3)), 5)
