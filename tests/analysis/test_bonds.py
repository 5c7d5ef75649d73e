# SPDX-License-Identifier: GPL-2.0-or-later
"""Bond angles and crystal-like grains of FCC, HCP and random packings."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.special import sph_harm
from spot_analysis.statistics import bond_angles, bond_order
from spot_analysis.statistics.bonds import BOND_CUTOFF, find_bonds
from spot_analysis.statistics.region import Region

from synthetic import fcc, hcp, middle_of, sequential_packing

REGION = Region(3, 5, 11)
# degrees -> angles between the bonds of one grain
ANGLES = {"fcc": {60: 24, 90: 12, 120: 24, 180: 6},
          "hcp": {60: 24, 90: 12, 109.4712: 3, 120: 18, 146.4427: 6, 180: 3}}


def crystal(name, spacing=1.0):
    """Crystal that goes on for 3 d and more around REGION, in y, too, where the region ends."""
    points = middle_of(fcc((9, 9, 12), spacing) if name == "fcc" else hcp((13, 8, 10), spacing))
    return points


class Inner(Region):
    """A region that ends before the crystal does in y, too."""

    def contains(self, positions, margin=0.0):
        return super().contains(positions, margin) & (np.abs(positions[:, 1]) < 2 + margin)


@pytest.mark.parametrize("name", ["fcc", "hcp"])
def test_angles_of_a_crystal_are_exact(name):
    bonds = find_bonds(crystal(name), Inner(3, 5, 11))
    counts = bond_angles.angle_counts(bonds)
    grains = bonds.inside.sum()
    expected = np.zeros(bond_angles.BINS)
    for degrees, number in ANGLES[name].items():
        expected[min(int(degrees), bond_angles.BINS - 1)] += number
    np.testing.assert_allclose(counts / grains, expected)


@pytest.mark.parametrize("name", ["fcc", "hcp"])
@pytest.mark.parametrize("spacing", [0.99, 1.05])
def test_crystals_are_crystal_like(name, spacing):
    assert bond_order.crystal_share(find_bonds(crystal(name, spacing), Inner(3, 5, 11))) == 1


def test_random_packings_are_not():
    points = sequential_packing(np.random.default_rng(3), 500, [-5, -4, 2], [5, 4, 14], 0.95)
    assert bond_order.crystal_share(find_bonds(points, REGION)) == 0


def test_harmonics():
    vectors = np.random.default_rng(0).normal(size=(50, 3))
    vectors /= np.linalg.norm(vectors, axis=1)[:, None]
    azimuth, polar = np.arctan2(vectors[:, 1], vectors[:, 0]), np.arccos(vectors[:, 2])
    expected = np.stack([sph_harm(m, 6, azimuth, polar) for m in range(7)], axis=1)
    np.testing.assert_allclose(bond_order.harmonics(vectors), expected, atol=1e-12)


def test_order_does_not_depend_on_the_axes():
    points = sequential_packing(np.random.default_rng(5), 300, [-4, -4, 3], [4, 4, 13], 0.9)
    bonds = find_bonds(points, Region(9, 0, 20))
    turned = find_bonds(Rotation.from_euler("xyz", [0.3, 1.0, 2.0]).apply(points) + [0, 0, 20], Region(30, -10, 60))

    def products(some):
        vectors = bond_order.order_vectors(some)
        return np.sort((vectors[some.first] * vectors[some.second]).sum(axis=1))

    np.testing.assert_allclose(products(turned), products(bonds), atol=1e-10)


@pytest.mark.parametrize("seed", range(5))
def test_bonds_by_tree_equal_all_pairs(seed):
    points = sequential_packing(np.random.default_rng(seed), 500, [-5, -3, 2], [5, 3, 14], 0.85)
    inside = REGION.contains(points)
    counts, crystal_like = np.zeros(bond_angles.BINS, dtype=int), 0
    vectors = {}
    for grain, place in enumerate(points):
        to = points - place
        length = np.linalg.norm(to, axis=1)
        near = (length > 0) & (length < BOND_CUTOFF)
        unit = to[near] / length[near, None]
        harmonics = np.array([sph_harm(m, 6, np.arctan2(unit[:, 1], unit[:, 0]), np.arccos(unit[:, 2])).sum()
                              for m in range(-6, 7)])
        vectors[grain] = np.flatnonzero(near), unit, harmonics / (np.linalg.norm(harmonics) or 1)
    for grain in np.flatnonzero(inside):
        near, unit, own = vectors[grain]
        angle = np.degrees(np.arccos((unit @ unit.T).clip(-1, 1)))[np.triu_indices(len(unit), 1)]
        counts += np.histogram(angle, np.arange(bond_angles.BINS + 1))[0]
        connected = sum((own @ vectors[other][2].conj()).real > bond_order.CONNECTED for other in near)
        crystal_like += connected >= bond_order.CONNECTIONS
    bonds = find_bonds(points, REGION)
    np.testing.assert_array_equal(bond_angles.angle_counts(bonds), counts)
    assert bond_order.crystal_share(bonds) == crystal_like / inside.sum()


def test_density_of_angles():
    counts = np.zeros(bond_angles.BINS)
    counts[60:62] = 3, 1
    density = bond_angles.density(counts)
    assert density[30] == 0.5 and density.sum() * bond_angles.REBIN == 1
    assert math.isnan(bond_angles.density(np.zeros(bond_angles.BINS))[0])


def test_no_grains():
    bonds = find_bonds(np.empty((0, 3)), REGION)
    assert bond_angles.angle_counts(bonds).sum() == 0 and math.isnan(bond_order.crystal_share(bonds))
