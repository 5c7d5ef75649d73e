# SPDX-License-Identifier: GPL-2.0-or-later
"""C(r), b_p and the width of the flow from motion whose answer is known."""

import math

import numpy as np
import pytest
from spot_analysis.calibration.diffusion import fit_diffusion
from spot_analysis.calibration.estimate import CalibrationError, estimate
from spot_analysis.reading.container import Container
from spot_analysis.statistics import (fits, frame_correlation, particle_diffusion, profile_width, stagnation,
                                      velocity_correlation)
from spot_analysis.statistics.bootstrap import block_sums, bootstrap_error
from spot_analysis.statistics.flow import velocity_profile
from spot_analysis.statistics.mean_flow import SIZE, UPPER, Step, about_mean_flow, core, inclination_terms, triangles
from spot_analysis.statistics.region import Region

from synthetic import make_snapshots, measure

SILO = Container(25, 4, 4)
REGION = Region(15, 15, 45)
CORE = core(SILO, velocity_correlation.BOTTOM, velocity_correlation.TOP)


def correlated_frame(rng, points, beta, alpha, flow):
    """w of grains at ``points``: dx with covariance alpha exp(-r/beta) and a local part, on ``flow`` times streamlines."""
    distance = np.linalg.norm(points[:, None] - points, axis=2)
    covariance = alpha * np.exp(-distance / beta) + (1 - alpha + 1e-9) * np.eye(len(points))
    dx = 0.02 * np.linalg.cholesky(covariance) @ rng.normal(size=len(points))
    drop = rng.uniform(0.2, 0.4) * rng.uniform(0.7, 1.0, len(points))
    x, _, z = points.T
    return np.column_stack([dx + flow * drop * (0.6 - x / 2) / z, drop[:, None] * inclination_terms(x, z)])


def sums_of_frames(rng, frames, beta, alpha, flow=1.0):
    """One row a frame, as the measurement stores them."""
    rows = []
    for _ in range(frames):
        points = rng.uniform([-8, -2.5, 50], [8, 2.5, 66], (400, 3))
        grains, own, pairs, joint = velocity_correlation.frame_sums(points, correlated_frame(rng, points, beta, alpha, flow))
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
    assert np.abs(curve - expected).max() < 0.06


def test_streamlines_of_a_free_walk_leave_no_trace():
    """The same fluctuations with and without a mean flow ten times as fast, whose drop swings and differs from grain to
    grain."""
    with_flow, without = (velocity_correlation.correlation(sums_of_frames(np.random.default_rng(2), 5, 1.5, 0.8, flow)
                                                           .sum(axis=0)) for flow in (1.0, 0.0))
    np.testing.assert_allclose(with_flow, without, atol=1e-7)


def test_frame_sums_equal_all_pairs():
    rng = np.random.default_rng(4)
    middle, w = rng.uniform([-8, -2.5, 50], [8, 2.5, 66], (200, 3)), rng.normal(size=(200, SIZE))
    grains, own, pairs, joint = velocity_correlation.frame_sums(middle, w)
    distance = np.linalg.norm(middle[:, None] - middle, axis=2)
    first, second = np.triu_indices(len(middle), 1)
    expected = np.zeros_like(joint)
    for i, j in zip(first, second):
        place = math.floor((distance[i, j] - 1) / 0.25)
        if 0 <= place < len(expected):
            product = np.outer(w[i], w[j])
            expected[place] += ((product + product.T) / 2)[UPPER]
    assert grains == 200
    np.testing.assert_array_equal(pairs, np.histogram(distance[first, second], velocity_correlation.EDGES)[0])
    np.testing.assert_allclose(joint, expected, atol=1e-12)
    np.testing.assert_allclose(own, (w.T @ w)[UPPER])


def test_only_grains_of_the_core_count():
    """Four grains fall by 0.5 d: one in the core, one at the wall in y, one beside and one above it."""
    start = np.array([[7, 2, 60.0], [7, 3, 60], [9, 0, 60], [7, 0, 66.4]])
    step = Step(*make_snapshots([start, start - [0, 0, 0.5]], [40, 42], SILO, REGION), CORE)
    assert step.ids.tolist() == [1, 2, 3] and step.inside.tolist() == [True, False, False] and step.fallen == 0.5
    with_margin = CORE.contains(start, margin=1.5)
    assert with_margin.tolist() == [True, False, True, True]


def test_linear_flow_of_a_frame_leaves_no_trace():
    """Sway, strain and rotation of each frame, a hundred times the fluctuations."""
    rng = np.random.default_rng(7)
    places = rng.uniform([-8, -2.5, 50], [8, 2.5, 66], (400, 3))
    own = rng.normal(size=400)
    carried = own + 100 * (1 + 0.3 * places[:, 0] - 0.2 * places[:, 2])
    np.testing.assert_allclose(frame_correlation.residuals(places, carried), frame_correlation.residuals(places, own), atol=1e-9)
    assert abs(frame_correlation.residuals(places, own) @ places[:, [0, 2]]).max() < 1e-7


def test_pair_sums_equal_all_pairs():
    rng = np.random.default_rng(9)
    places, u = rng.uniform([-8, -2.5, 50], [8, 2.5, 66], (200, 3)), rng.normal(size=200)
    first, second = np.triu_indices(200, 1)
    distance = np.linalg.norm(places[first] - places[second], axis=1)
    pairs, products = frame_correlation.pair_sums(places, u)
    np.testing.assert_array_equal(pairs, np.histogram(distance, velocity_correlation.EDGES)[0])
    np.testing.assert_allclose(products, np.histogram(distance, velocity_correlation.EDGES, weights=u[first] * u[second])[0])


def test_correlation_about_the_linear_flow_is_recovered():
    """Of frames whose grains are displaced with covariance alpha exp(-r/beta), in a flow that strains differently in each. Three
    fitted terms take some 3/400 of the variance and the integral of C(r) over the region away."""
    rng, beta, alpha = np.random.default_rng(11), 0.8, 0.9
    packings = []
    for _ in range(40):
        points = rng.uniform([-8, -2.5, 50], [8, 2.5, 71], (500, 3))
        distance = np.linalg.norm(points[:, None] - points, axis=2)
        covariance = alpha * np.exp(-distance / beta) + (1 - alpha) * np.eye(500)
        moved = 0.02 * np.linalg.cholesky(covariance) @ rng.normal(size=500)
        moved += 0.1 * rng.normal() * points[:, 0] / 8 + 0.1 * rng.normal()
        packings += [points - [[1, 0, 0]] * moved[:, None] / 2, points + [[1, 0, 0]] * moved[:, None] / 2]
    # each pair of frames is 2 tau apart, and 3 tau from the next
    times = np.array([5.0 * (k // 2) + 2.0 * (k % 2) for k in range(80)])
    part = measure(frame_correlation, packings, times, SILO, REGION)
    assert len(part.start) == 40 and np.all(part.end - part.start == 2)
    middle = velocity_correlation.middles()
    np.testing.assert_allclose(frame_correlation.correlation(part, np.arange(40)), alpha * np.exp(-middle / beta), atol=0.05)
    assert np.sqrt(part.squares.sum() / part.grains.sum()) == pytest.approx(0.01, rel=0.05)  # 0.02 d in 2 tau


def walk(rng, grains, steps, b, speed=0.25, streamlines=0.0):
    """Grains of the diffusion region that fall at their own speeds and walk with variance 2 b a unit of height, on streamlines
    x ~ z^(streamlines), 1/2 for a free walk of spots; (steps, grains, 3)."""
    positions = [rng.uniform([-16, -2.5, 15], [16, 2.5, 74], (grains, 3))]
    own = speed * rng.uniform(0.6, 1.4, grains)
    for _ in range(steps - 1):
        fall = 2 * own * rng.uniform(0.7, 1.3)  # the flow pulses
        x, y, z = positions[-1].T
        fall = np.minimum(fall, z - 1)
        later = x * ((z - fall) / z)**streamlines + rng.normal(size=grains) * np.sqrt(2 * b * fall)
        positions.append(np.column_stack([later, y, z - fall]))
    return np.array(positions)


def diffusion_sums(packings):
    times = 40 + 2.0 * np.arange(len(packings))
    part = measure(particle_diffusion, packings, times, SILO, REGION)
    return part, particle_diffusion.columns(part, times[-1])


@pytest.mark.parametrize("streamlines", [0.0, 0.5])
def test_known_diffusion_is_recovered(streamlines):
    """Streamlines, pulses and a spread of speeds leave no trace. The estimate scatters by 1.5 % from seed to seed."""
    packings = walk(np.random.default_rng(6), 40000, 20, 2.5e-3, streamlines=streamlines)
    _, columns = diffusion_sums(packings)
    assert particle_diffusion.diffusion_length(columns.sum(axis=0)) == pytest.approx(2.5e-3, rel=0.05)


def test_rattling_is_left_out():
    """Noise on every position adds to the variance, not to its slope."""
    rng = np.random.default_rng(8)
    packings = walk(rng, 40000, 20, 2.5e-3)
    noisy = packings + rng.normal(0, 0.03, packings.shape) * [1, 0, 0]
    quiet, loud = (particle_diffusion.variances(diffusion_sums(some)[1].sum(axis=0)) for some in (packings, noisy))
    np.testing.assert_allclose(loud - quiet, 2 * 0.03**2, rtol=0.25)


def test_streamlines_of_a_free_walk_leave_nothing():
    """They move a grain by up to 0.1 d a step; what is left is a thousandth of a fluctuation's variance."""
    _, columns = diffusion_sums(walk(np.random.default_rng(3), 4000, 20, 0.0, streamlines=0.5))
    assert np.abs(particle_diffusion.variances(columns.sum(axis=0))).max() < 2e-5


def test_rolling_along_the_walls_is_left_out():
    """Grains within 1 d of a wall in y with ten times the variance change nothing."""
    packings = walk(np.random.default_rng(6), 40000, 12, 2.5e-3, speed=0.4)
    rolling = walk(np.random.default_rng(7), 20000, 12, 2.5e-2, speed=0.4)
    rolling[..., 1] = np.where(rolling[..., 1] > 0, 3.5, -3.5)
    with_walls = np.concatenate([packings, rolling], axis=1)
    alone, both = (particle_diffusion.diffusion_length(diffusion_sums(some)[1].sum(axis=0)) for some in (packings, with_walls))
    assert alone == pytest.approx(both, rel=1e-12) and alone == pytest.approx(2.5e-3, rel=0.08)


def row_of_walkers(dx, drop=0.5):
    """``columns`` of grains that stay at one place of the core, summed over time; dx : (steps, grains). (steps, f)"""
    steps, grains = dx.shape
    rows = np.zeros((steps, 1 + particle_diffusion.LAGS * (1 + len(UPPER[0]))))
    counts, moments = rows[:, 1:1 + particle_diffusion.LAGS], rows[:, 1 + particle_diffusion.LAGS:]
    moments = moments.reshape(steps, particle_diffusion.LAGS, len(UPPER[0]))
    rows[:, 0] = grains * drop
    for lag in range(particle_diffusion.LAGS):
        counts[:steps - lag, lag] = grains
        moments[:steps - lag, lag, 0] = (dx[:steps - lag] * dx[lag:]).sum(axis=1)
    return rows


def steps_of_walkers(rng, steps, grains, b_p, cage=0.0):
    """Displacements (steps, grains) over drops of 0.5 d: diffusion b_p and a rattle of variance ``cage`` about it."""
    rattle = rng.normal(0, np.sqrt(cage), (steps + 1, grains))
    return rng.normal(0, np.sqrt(b_p), (steps, grains)) + np.diff(rattle, axis=0)


def fitted_diffusion(dx):
    times = 41.0 + 2 * np.arange(len(dx))
    return fit_diffusion(estimate(times, row_of_walkers(dx), (40.0, 40.0 + 2 * len(dx)), particle_diffusion.variances))


@pytest.mark.parametrize("cage", [0.0, 1e-3])
def test_a_cage_adds_a_constant_not_a_slope(cage):
    """Within three standard errors."""
    found = fitted_diffusion(steps_of_walkers(np.random.default_rng(0), 26, 2000, 2.5e-3, cage))
    assert found.length.error < 1e-4
    assert found.length.value == pytest.approx(2.5e-3, abs=3 * found.length.error)
    assert found.line.value[1] == pytest.approx(2 * cage, abs=3 * found.line.error[1])


def test_variance_against_the_obvious_way():
    """Of the sums of successive displacements, when every path is complete; edges of the interval count differently."""
    dx = steps_of_walkers(np.random.default_rng(1), 400, 50, 2.5e-3, 1e-3)
    path = np.concatenate([np.zeros((1, 50)), np.cumsum(dx, axis=0)])
    variances = particle_diffusion.variances(row_of_walkers(dx).sum(axis=0))
    for drop, variance in zip(particle_diffusion.DROPS, variances):
        steps = int(2 * drop)
        assert variance == pytest.approx(((path[steps:] - path[:-steps])**2).mean(), rel=0.04)


def test_errors_cover_the_truth():
    """Paths overlap, blocks do not depend on each other: 2 SE should cover about 91 % (8 blocks); 4 deviations are 10 %."""
    rng = np.random.default_rng(2)
    found = [fitted_diffusion(steps_of_walkers(rng, 26, 60, 2.5e-3)).length for _ in range(150)]
    covered = np.mean([abs(one.value - 2.5e-3) < 2 * one.error for one in found])
    assert 0.79 < covered <= 1


def test_grains_that_do_not_diffuse_are_refused():
    with pytest.raises(CalibrationError, match="does not grow with the drop"):
        fitted_diffusion(steps_of_walkers(np.random.default_rng(0), 20, 100, 0.0, cage=1e-3))


def test_grains_that_leave_count_while_they_can_be_followed():
    packings = np.repeat(np.random.default_rng(0).uniform([-4, -2, 27], [4, 2, 70], (1, 400, 3)), 7, axis=0)
    packings += np.linspace(0, -1, 7)[:, None, None] * [0, 0, 1]
    inside = int(((packings[0, :, 2] < 66) & (packings[0, :, 2] > 28)).sum())
    packings[4:, np.argmin(np.abs(packings[0, :, 2] - 40))] = np.nan
    part, _ = diffusion_sums(packings)
    assert part.grains[0, :3].tolist() == part.grains[0, [0, 0, 0]].tolist() and part.grains[0, 0] >= inside
    assert part.grains[0, 3] == part.grains[0, 4] == part.grains[0, 0] - 1
    assert part.grains[-1].tolist() == [part.grains[-1, 0]] + 13 * [0]


def test_fluctuations_about_a_known_mean_flow():
    """q.M.q of ``about_mean_flow`` is the sum of squares of what least squares leave."""
    w = np.random.default_rng(5).normal(size=(300, SIZE))
    own = triangles(w.T @ w)
    left = w[:, 0] - w[:, 1:] @ np.linalg.lstsq(w[:, 1:], w[:, 0], rcond=None)[0]
    np.testing.assert_allclose(about_mean_flow(own, own[None]), [(left**2).sum()])


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
