# SPDX-License-Identifier: GPL-2.0-or-later
"""R_s from C(r): the forms against integration at random, and synthetic velocities of known radius."""

import numpy as np
import pytest
from scipy.spatial import cKDTree
from spot_analysis import calibration_correlation as correlation
from spot_analysis.calibration_estimate import CalibrationError

SPAN = (40.0, 64.0)
TIMES = np.arange(41.0, 64.0, 2.0)
LOW, HIGH = np.array([-8, -3.5, 0]), np.array([8, 3.5, 16])
REACH = 3.0  # spots in |y| < 3


def test_lens_of_discs():
    """Against counts on a fine grid."""
    x, y = np.meshgrid(*2 * [np.linspace(-4, 4, 1601)])
    for one, other, apart in [(2, 1.5, 1), (2, 1.5, 3), (2, 1, 0.5), (1, 1, 0.0001), (1, 1, 2.5), (0, 1, 0.5)]:
        both = (x**2 + y**2 < one**2) & ((x - apart)**2 + y**2 < other**2)
        area = correlation._lens(*(np.array(float(value)) for value in (one, other, apart)))
        assert area == pytest.approx(both.sum() * 0.005**2, abs=0.02), (one, other, apart)


def test_form_without_walls_is_that_of_spheres():
    points = np.random.default_rng(0).uniform(LOW, HIGH, (1500, 3))
    form = correlation.walled_form(correlation.pair_geometry(points), 2.6, 6.2)
    middles = (correlation.EDGES[1:] + correlation.EDGES[:-1]) / 2
    np.testing.assert_allclose(form, correlation.sphere_form(middles, 2.6), atol=0.03)


def test_walled_form_against_spots_at_random():
    rng = np.random.default_rng(1)
    points = rng.uniform(LOW, HIGH, (800, 3))
    spots = rng.uniform([-11, -REACH, -3], [11, REACH, 19], (4000, 3))
    within = (((points[:, None] - spots)**2).sum(axis=-1) < 2.6**2).astype(float)
    first, second, distance = correlation.close_pairs(points)
    shared = np.einsum("ps,ps->p", within[first[::10]], within[second[::10]])
    bins = np.digitize(distance[::10], correlation.EDGES) - 1
    counted = np.array([shared[bins == number].mean() for number in range(20)]) / within.sum(axis=1).mean()
    form = correlation.walled_form(correlation.pair_geometry(points), 2.6, REACH)
    np.testing.assert_allclose(form, counted, atol=0.03)


def kicks(rng, points, radius, spots, noise=0.0, sway=0.0):
    """Velocities: each spot gives all points within ``radius`` the same kick; plus noise and a sway of all."""
    centres = rng.uniform([-8 - radius, -REACH, -radius], [8 + radius, REACH, 16 + radius], (spots, 3))
    near = cKDTree(points).query_ball_point(centres, radius)
    velocity = np.zeros(len(points))
    for grains, kick in zip(near, rng.normal(size=spots)):
        velocity[grains] += kick
    scale = velocity.std()
    return velocity + noise * scale * rng.normal(size=len(points)) + sway * scale * rng.normal()


def fitted(radius, seed=2, **options):
    rng = np.random.default_rng(seed)
    samples = []
    for _ in TIMES:
        points = rng.uniform(LOW, HIGH, (1500, 3))
        samples.append(correlation.correlation_sums(points, kicks(rng, points, radius, 800, **options)))
    return correlation.fit_correlation(TIMES, np.array(samples), SPAN, correlation.pair_geometry(points), REACH)


@pytest.mark.parametrize("radius", [2.0, 2.6, 3.2])
def test_known_radius(radius):
    found = fitted(radius)
    assert found.radius.error < 0.3
    assert found.radius.value == pytest.approx(radius, abs=3 * found.radius.error)
    assert found.amplitude.value == pytest.approx(1, abs=3 * found.amplitude.error)
    assert found.bulk_radius.value > found.radius.value  # walls hide part of the sphere


def test_noise_and_sway_leave_the_radius():
    found = fitted(2.6, noise=1.0, sway=0.5)
    assert found.radius.value == pytest.approx(2.6, abs=3 * found.radius.error)
    assert found.amplitude.value < 0.6 and found.background.value > 0.03
    assert found.decay.value > 2.6  # 2006's beta takes the sway for a long decay


def test_velocities_at_random_are_refused():
    rng = np.random.default_rng(4)
    points = rng.uniform(LOW, HIGH, (1500, 3))
    samples = [correlation.correlation_sums(points, rng.normal(size=1500)) for _ in TIMES]
    with pytest.raises(CalibrationError, match="no shape that gives R_s"):
        correlation.fit_correlation(TIMES, np.array(samples), SPAN, correlation.pair_geometry(points), REACH)


def test_too_few_pairs_are_refused():
    with pytest.raises(CalibrationError, match="no pairs of grains"):
        correlation.pair_geometry(np.random.default_rng(0).uniform(0, 40, (20, 3)))
