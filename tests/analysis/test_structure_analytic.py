# SPDX-License-Identifier: GPL-2.0-or-later
"""g(r), contacts and packing fraction where the answer is known."""

import math

import numpy as np
import pytest
from spot_analysis.reading.container import Container
from spot_analysis.statistics import neighbours, radial_distribution, structure
from spot_analysis.statistics.region import Region

from synthetic import fcc

SILO = Container(25, 4, 4)
REGION = Region(15, 15, 45)


def test_ideal_gas_in_a_slab_has_g_of_one_to_10_d():
    """Points placed evenly over the centres' range, 40 samples. Each of 20 shells within 4.5 standard errors of 1,
    taken from the scatter of the samples: a false alarm once in 1,000 seeds, and an error of 1 % would be seen."""
    rng = np.random.default_rng(7)
    edges = np.linspace(0, 10, 21)
    samples = []
    for _ in range(40):
        points = rng.uniform([-25.5, -3.5, 4.5], [25.5, 3.5, 55.5], (1800, 3))
        pairs = neighbours.region_pairs(points, REGION, reach=10)
        samples.append(radial_distribution.slab_rdf(radial_distribution.rdf_counts(pairs, edges), pairs.grains, 1, REGION, SILO, edges))
    error = np.std(samples, axis=0, ddof=1) / math.sqrt(len(samples))
    deviation = np.mean(samples, axis=0) - 1
    assert error[5:].max() < 0.02
    # the region's own density, which g is divided by, counts the grain itself: 1/630 too much
    assert np.all(np.abs(deviation) < 4.5 * error + 1 / 600)


def test_ideal_partners_follow_the_slab_formula():
    r = np.linspace(0.2, 12, 4001)
    expected = np.where(r <= 7, 4 * math.pi * r**2 * (1 - r / 14), 4 * math.pi * r**2 * 7 / (2 * r))
    integral = np.diff(radial_distribution._ideal_partners(r, 7.0))
    np.testing.assert_allclose(integral, np.diff(r) * (expected[1:] + expected[:-1]) / 2, rtol=1e-3)


@pytest.fixture(scope="module")
def crystal():
    """FCC, nearest neighbours 0.999 d apart, 8 cells or 16 layers of (100) between the walls in y."""
    points = fcc((34, 8, 40), 0.999)
    return points - [points[:, 0].mean(), points[:, 1].mean(), 0]


def test_fcc_coordination_is_12_but_8_in_the_two_outer_layers(crystal):
    pairs = neighbours.region_pairs(crystal, REGION)
    assert structure.contacts_per_grain(pairs) == pytest.approx((12 * 14 + 8 * 2) / 16, rel=1e-12)
    assert structure.badness(pairs) == pytest.approx((12 * 14 + 8 * 2) / 16 * 0.001**2, rel=1e-6)
    assert neighbours.largest_overlap(crystal) == pytest.approx(0.001)


def test_fcc_peaks(crystal):
    pairs = neighbours.region_pairs(crystal, REGION)
    counts = radial_distribution.rdf_counts(pairs, np.linspace(0, 2.5, 251))
    peaks = (np.flatnonzero(counts) + 0.5) * 0.01
    np.testing.assert_allclose(peaks, 0.999 * np.sqrt([1, 2, 3, 4, 5, 6]), atol=0.0051)


def test_fcc_packing_fraction():
    """A region of 8 x 8 cells of edge sqrt(2) d, 4 grains each, over the walls' distance."""
    edge = math.sqrt(2)
    points = fcc((20, 4, 20), 1.0) + 0.01
    points[:, 0] -= 10 * edge
    region = Region(4 * edge, 4 * edge, 12 * edge)
    container = Container(25, 2 * edge, 4)
    grains = int(region.contains(points).sum())
    assert structure.packing_fraction(grains, region, container) == pytest.approx(math.pi / math.sqrt(18), rel=1e-12)
