# SPDX-License-Identifier: GPL-2.0-or-later
"""Pairs by tree against all pairs, on random packings."""

import numpy as np
import pytest
from spot_analysis.statistics import neighbours, radial_distribution, structure
from spot_analysis.statistics.region import Region

from synthetic import sequential_packing

REGION = Region(4, 3, 9)


def all_pairs(points):
    """Every pair of a grain of REGION with another, both ends apart: distances (k,) and number of grains."""
    inside = REGION.contains(points)
    distance = np.linalg.norm(points[inside][:, None] - points, axis=2)
    return distance[distance > 0], inside.sum()


@pytest.mark.parametrize("seed", range(10))
def test_contacts_badness_and_rdf(seed):
    points = sequential_packing(np.random.default_rng(seed), 700, [-8, -3, 0], [8, 3, 14], 0.85)
    distance, grains = all_pairs(points)
    pairs = neighbours.region_pairs(points, REGION)
    touching = distance[distance < 1]
    assert pairs.grains == grains
    assert structure.contacts_per_grain(pairs) == pytest.approx(len(touching) / grains)
    assert structure.badness(pairs) == pytest.approx(((1 - touching)**2).sum() / grains)
    np.testing.assert_array_equal(radial_distribution.rdf_counts(pairs), np.histogram(distance, radial_distribution.RDF_EDGES)[0])
    everywhere = np.linalg.norm(points[:, None] - points, axis=2)[np.triu_indices(len(points), 1)]
    assert neighbours.largest_overlap(points) == pytest.approx(1 - everywhere.min())


def test_few_grains():
    for points in (np.empty((0, 3)), np.array([[0.0, 0, 5]])):
        assert neighbours.largest_overlap(points) == 0
        assert neighbours.region_pairs(points, REGION).distance.size == 0
