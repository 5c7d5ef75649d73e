# SPDX-License-Identifier: GPL-2.0-or-later
"""C(r), b_p and the width of the flow from motion whose answer is known."""

import math

import numpy as np
import pytest
from spot_analysis import fits, particle_diffusion, profile_width, stagnation, velocity_correlation
from spot_analysis.bootstrap import block_sums, bootstrap_error
from spot_analysis.container import Container, Region
from spot_analysis.flow import velocity_profile

from synthetic import measure

SILO = Container(25, 4, 4)
REGION = Region(15, 15, 45)
CORE = velocity_correlation.correlation_region(SILO)


def mean_flow(points, amplitude):
    """A field of the kind that is subtracted."""
    x, z = points[:, 0] / CORE.half_width, (points[:, 2] - 58) / 8
    return amplitude * (0.1 - 0.4 * x + 0.2 * x * z + 0.1 * x**3)


def correlated_frame(rng, points, beta, alpha, flow):
    """Start and end of one step: v_x with covariance alpha exp(-r/beta) and a local part, v_z even."""
    distance = np.linalg.norm(points[:, None] - points, axis=2)
    covariance = alpha * np.exp(-distance / beta) + (1 - alpha + 1e-9) * np.eye(len(points))
    v = 0.02 * np.linalg.cholesky(covariance) @ rng.normal(size=len(points))
    amplitude = rng.uniform(0.2, 0.4)
    velocity = np.column_stack([v + flow * mean_flow(points, amplitude), 0 * v, np.full(len(v), -amplitude)])
    return points - velocity, points + velocity  # 2 tau apart, middles at the points


def sums_of_frames(rng, frames, beta, alpha, flow=1.0):
    """One row a frame, as the measurement stores them."""
    rows = []
    for _ in range(frames):
        points = rng.uniform([-8, -4, 50], [8, 4, 66], (400, 3))
        grains, own, pairs, joint = velocity_correlation.frame_sums(*correlated_frame(rng, points, beta, alpha, flow), 2.0,
                                                                    CORE)
        rows.append(np.concatenate([[grains], own, pairs, joint.ravel()]))
    return np.array(rows)


@pytest.mark.parametrize("beta, alpha", [(1.5, 0.8), (0.8, 1.0)])
def test_known_correlation_is_recovered(beta, alpha):
    """The fitted length within 4 of its bootstrapped errors. Taking a mean field out of 400 grains a frame lowers C(r) by
    about as much as its integral over the region, which is small for these lengths."""
    rows = sums_of_frames(np.random.default_rng(1), 60, beta, alpha)
    curve = velocity_correlation.correlation(rows.sum(axis=0))
    found_alpha, found_beta = velocity_correlation.fit(curve)
    sums = block_sums(np.arange(60) * 2.0, rows, (0, 120))
    error = bootstrap_error(sums, lambda s: velocity_correlation.fit(velocity_correlation.correlation(s))[1])
    assert 0 < error < 0.3 * beta
    assert found_beta == pytest.approx(beta, abs=4 * error)
    assert found_alpha == pytest.approx(alpha, rel=0.3)
    # bins of 0.25 d hold the mean over the shell, which is not that at its middle: 0.5 %
    expected = alpha * np.exp(-velocity_correlation.middles() / beta)
    assert np.abs(curve - expected)[velocity_correlation.fitted()].max() < 0.06


def test_mean_flow_of_changing_amplitude_leaves_no_trace():
    """The same fluctuations with and without a mean flow ten times as fast."""
    with_flow, without = (velocity_correlation.correlation(sums_of_frames(np.random.default_rng(2), 5, 1.5, 0.8, flow)
                                                           .sum(axis=0)) for flow in (1.0, 0.0))
    np.testing.assert_allclose(with_flow, without, atol=1e-7)


def test_frame_sums_equal_all_pairs():
    rng = np.random.default_rng(4)
    start = rng.uniform([-10, -4, 48], [10, 4, 68], (200, 3))
    end = start + rng.normal(0, 0.1, start.shape)
    grains, own, pairs, joint = velocity_correlation.frame_sums(start, end, 2.0, CORE)
    middle = (start + end) / 2
    inside = CORE.contains(middle)
    middle, v = middle[inside], ((end - start) / 2)[inside]
    w = np.column_stack([v[:, 0], -v[:, 2].mean() * velocity_correlation.mean_flow_terms(middle[:, 0], middle[:, 2], CORE)])
    distance = np.linalg.norm(middle[:, None] - middle, axis=2)
    first, second = np.triu_indices(len(middle), 1)
    expected = np.zeros_like(joint)
    for i, j in zip(first, second):
        place = int(distance[i, j] / 0.25)
        if place < len(expected):
            product = np.outer(w[i], w[j])
            expected[place] += ((product + product.T) / 2)[velocity_correlation.UPPER]
    assert grains == inside.sum()
    np.testing.assert_array_equal(pairs, np.histogram(distance[first, second], velocity_correlation.EDGES)[0])
    np.testing.assert_allclose(joint, expected, atol=1e-12)
    np.testing.assert_allclose(own, (w.T @ w)[velocity_correlation.UPPER])


def walk(rng, grains, steps, b, speed=0.25, inclination=0.0):
    """Grains of the diffusion region that fall at their own speeds and walk with variance 2 b a unit of height, on streamlines
    of the inclination -dx/dz = -inclination x; (steps, grains, 3)."""
    positions = [rng.uniform([-16, -4, 15], [16, 4, 74], (grains, 3))]
    own = speed * rng.uniform(0.6, 1.4, grains)
    for _ in range(steps - 1):
        fall = 2 * own * rng.uniform(0.7, 1.3)  # the flow pulses
        x, y, z = positions[-1].T
        half = inclination * fall / 2  # the mean flow at the middle of the step
        later = (x * (1 - half) + rng.normal(size=grains) * np.sqrt(2 * b * fall)) / (1 + half)
        positions.append(np.column_stack([later, y, z - fall]))
    return np.array(positions)


def diffusion_sums(packings):
    times = 40 + 2.0 * np.arange(len(packings))
    part = measure(particle_diffusion, packings, times, SILO, REGION)
    return part, particle_diffusion._columns(part, times[-1])


@pytest.mark.parametrize("inclination", [0.0, 0.02])
def test_known_diffusion_is_recovered(inclination):
    """Streamlines, pulses and a spread of speeds leave no trace. The estimate scatters by 1.5 % from seed to seed."""
    packings = walk(np.random.default_rng(6), 40000, 20, 2.5e-3, inclination=inclination)
    _, columns = diffusion_sums(packings)
    assert particle_diffusion.diffusion_length(columns.sum(axis=0)) == pytest.approx(2.5e-3, rel=0.05)


def test_rattling_is_left_out():
    """Noise on every position adds to the variance, not to its slope."""
    rng = np.random.default_rng(8)
    packings = walk(rng, 40000, 20, 2.5e-3)
    noisy = packings + rng.normal(0, 0.03, packings.shape) * [1, 0, 0]
    quiet, loud = (particle_diffusion.variances(diffusion_sums(some)[1].sum(axis=0)) for some in (packings, noisy))
    np.testing.assert_allclose(loud - quiet, 2 * 0.03**2, rtol=0.25)


def test_too_few_steps_give_no_diffusion():
    _, columns = diffusion_sums(walk(np.random.default_rng(1), 4000, 6, 2.5e-3))
    assert math.isnan(particle_diffusion.diffusion_length(columns.sum(axis=0)))


def gaussian_flow(b, heights, edges, half_width=25.0):
    """Counts and sums of profiles whose variance is 2 b z."""
    rng = np.random.default_rng(9)
    start = rng.uniform([-half_width, -4, 5], [half_width, 4, 45], (400000, 3))
    fall = 2 * 3 * np.exp(-start[:, 0]**2 / (4 * b * start[:, 2])) / np.sqrt(start[:, 2])
    end = start - np.outer(fall, [0, 0, 1]) * 0.01
    return velocity_profile(start, end, 0.02, heights, edges)


def test_slope_of_the_line_is_twice_b():
    """Bins of 1 d add 1/12 d^2 to each variance, slices 2 d thick nothing to the slope."""
    heights, edges = np.array([10.0, 15, 20, 25, 30, 35, 40]), np.linspace(-25, 25, 51)
    variances = profile_width.gaussian_variance(*gaussian_flow(1.14, heights, edges), edges)
    slope, intercept = profile_width.line(heights, variances)
    assert slope == pytest.approx(2.28, rel=0.02)
    assert intercept == pytest.approx(1 / 12, abs=0.6)


def test_boundary_of_the_stagnant_zone_of_a_gaussian_profile():
    edges = np.linspace(-25, 25, 51)
    x = (edges[1:] + edges[:-1]) / 2
    counts = np.full(50, 1000)
    speed = np.exp(-x**2 / (2 * 6**2))
    axis = speed[np.abs(x) < stagnation.AXIS].mean()
    expected = 6 * math.sqrt(-2 * math.log(stagnation.SHARE * axis))
    assert stagnation.boundary(counts, counts * speed, edges) == pytest.approx(expected, abs=0.05)  # straight between bins
    assert math.isnan(stagnation.boundary(counts, counts * 1.0, edges))
    assert math.isnan(stagnation.boundary(counts, counts * 0.0, edges))


def test_fits():
    x = np.linspace(1, 6, 21)
    curves = np.array([0.7 * np.exp(-x / 1.87), 0.2 * np.exp(-x / 4.0)])
    alpha, beta = fits.fit_exponential(x, curves)
    np.testing.assert_allclose(alpha, [0.7, 0.2], rtol=1e-3)
    np.testing.assert_allclose(beta, [1.87, 4.0], rtol=1e-3)
    assert np.isnan(fits.fit_exponential(x, np.ones_like(x))[1])
    assert np.isnan(fits.fit_exponential(x, np.where(x > 5, np.nan, curves[0]))[1])
    wide = np.linspace(-24, 24, 49)
    height, width = fits.fit_gaussian(wide, 0.3 * np.exp(-wide**2 / 50))
    assert height == pytest.approx(0.3, rel=1e-4) and width == pytest.approx(5, rel=1e-4)
    slope, intercept = fits.fit_line(x, np.stack([2 * x + 1, -x]))
    np.testing.assert_allclose([slope, intercept], [[2, -1], [1, 0]], atol=1e-12)
