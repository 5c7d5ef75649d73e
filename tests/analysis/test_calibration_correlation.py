# SPDX-License-Identifier: GPL-2.0-or-later
"""R_s from C(r): the forms against integration at random, and synthetic velocities of known radius."""

import numpy as np
import pytest
from scipy.spatial import cKDTree
from spot_analysis.calibration import correlation
from spot_analysis.calibration.estimate import CalibrationError, estimate
from spot_analysis.statistics import velocity_correlation
from spot_analysis.statistics.mean_flow import SIZE
from spot_analysis.statistics.region import Region

SPAN = (40.0, 64.0)
TIMES = np.arange(41.0, 64.0, 2.0)
CORE = Region(8, 0, 16, 3.5)
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
    """The share that two spheres of the same radius have in common (2006); the pairs of a bin scatter it by 0.02."""
    form = correlation.walled_form(correlation.pair_geometry(CORE), 2.6, 6.2)
    share = np.minimum(velocity_correlation.middles() / 5.2, 1)
    np.testing.assert_allclose(form, 1 - 1.5 * share + 0.5 * share**3, atol=0.03)


def test_walled_form_against_spots_at_random():
    rng = np.random.default_rng(1)
    points = rng.uniform(LOW, HIGH, (800, 3))
    spots = rng.uniform([-11, -REACH, -3], [11, REACH, 19], (4000, 3))
    within = (((points[:, None] - spots)**2).sum(axis=-1) < 2.6**2).astype(float)
    first, second = np.triu_indices(len(points), 1)
    distance = np.linalg.norm(points[first] - points[second], axis=1)
    first, second, distance = (some[(distance > 1) & (distance < 6)][::2] for some in (first, second, distance))
    shared = np.einsum("ps,ps->p", within[first], within[second])
    bins = np.digitize(distance, velocity_correlation.EDGES) - 1
    counted = np.array([shared[bins == number].mean() for number in range(20)]) / within.sum(axis=1).mean()
    np.testing.assert_allclose(correlation.walled_form(correlation.pair_geometry(CORE), 2.6, REACH), counted, atol=0.03)


def kicks(rng, points, radius, spots, noise=0.0, sway=0.0):
    """Velocities: each spot gives all points within ``radius`` the same kick; plus noise and a sway of all."""
    centres = rng.uniform([-8 - radius, -REACH, -radius], [8 + radius, REACH, 16 + radius], (spots, 3))
    near = cKDTree(points).query_ball_point(centres, radius)
    velocity = np.zeros(len(points))
    for grains, kick in zip(near, rng.normal(size=spots)):
        velocity[grains] += kick
    scale = velocity.std()
    return velocity + noise * scale * rng.normal(size=len(points)) + sway * scale * rng.normal()


def row(points, velocity):
    """What the measurement stores of one frame, without a mean flow."""
    grains, own, pairs, joint = velocity_correlation.frame_sums(points, np.pad(velocity[:, None], ((0, 0), (0, SIZE - 1))))
    return np.concatenate([[grains], own, pairs, joint.ravel()])


def fit(rows):
    curve = estimate(TIMES, np.array(rows), SPAN, velocity_correlation.correlation)
    return correlation.fit_correlation(curve, correlation.pair_geometry(CORE), REACH)


def fitted(radius, seed=2, **options):
    rng = np.random.default_rng(seed)
    rows = []
    for _ in TIMES:
        points = rng.uniform(LOW, HIGH, (1500, 3))
        rows.append(row(points, kicks(rng, points, radius, 800, **options)))
    return fit(rows)


@pytest.mark.parametrize("radius", [2.0, 2.6, 3.2])
def test_known_radius(radius):
    """Within three standard errors, as are all comparisons here."""
    found = fitted(radius)
    assert found.radius.error < 0.3
    assert found.radius.value == pytest.approx(radius, abs=3 * found.radius.error)
    assert found.amplitude.value == pytest.approx(1, abs=3 * found.amplitude.error)


def test_noise_and_sway_leave_the_radius():
    found = fitted(2.6, noise=1.0, sway=0.5)
    assert found.radius.value == pytest.approx(2.6, abs=3 * found.radius.error)
    assert found.amplitude.value < 0.6 and found.background.value > 0.03
    assert found.decay.value[1] > 2.6  # 2006's beta takes the sway for a long decay


def test_velocities_at_random_are_refused():
    rng = np.random.default_rng(4)
    with pytest.raises(CalibrationError, match="no shape that gives R_s"):
        fit([row(rng.uniform(LOW, HIGH, (1500, 3)), rng.normal(size=1500)) for _ in TIMES])
