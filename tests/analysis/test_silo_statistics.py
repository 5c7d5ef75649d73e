# SPDX-License-Identifier: GPL-2.0-or-later
"""Surface, thickness, residence, mixing, front, fluctuations and slices of time, where the answer is known."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from spot_analysis.reading.container import Container
from spot_analysis.statistics import fluctuations, free_surface, front, mixing, residence, thickness, through_time
from spot_analysis.statistics.bonds import find_bonds
from spot_analysis.statistics.bootstrap import block_sums, bootstrap_error
from spot_analysis.statistics.history import History
from spot_analysis.statistics.interval import Interval
from spot_analysis.statistics.interval_view import IntervalView
from spot_analysis.statistics.region import Region

from synthetic import make_snapshots, measure, plug

SILO = Container(10, 4, 4)
REGION = Region(6, 15, 45)


def test_angle_of_a_slope():
    at = free_surface.places(Container(25, 4, 4))
    np.testing.assert_allclose(at, 2.5 * np.arange(1, 11) - 1.25)
    rng = np.random.default_rng(0)
    points = rng.uniform([-25, -4, 0], [25, 4, 60], (200000, 3))
    points = points[points[:, 2] < 30 + np.abs(points[:, 0]) * math.tan(math.radians(20))]
    heights = free_surface.surface_heights(points, at)
    assert free_surface.angle(at, heights) == pytest.approx(20, abs=0.2)
    assert np.isnan(free_surface.surface_heights(points[points[:, 0] > 5], at)[0])


def test_solid_fraction_keeps_the_volume():
    """Of a layer of 100 grains at y = 0.3 d: its slices add up to 100 grains, and the thickest is a full circle."""
    edges = np.linspace(-4, 4, 65)
    counts = np.zeros(64)
    counts[np.searchsorted(edges, 0.3) - 1] = 100
    fraction = thickness.solid_fraction(counts, 1, edges, 400.0)
    assert fraction.sum() * 0.125 * 400 == pytest.approx(100 * math.pi / 6)
    assert fraction.max() == pytest.approx(100 * math.pi / 4 / 400, rel=0.01)
    assert np.ptp(edges[:-1][fraction > 0]) <= 1


def falling_plug(times, layers_a_lag=1.0):
    """The plug at these times; grains below z = 0 have left."""
    for time in times:
        packing = plug() - [0, 0, layers_a_lag * 0.99 * time / 2]
        packing[packing[:, 2] < 0] = np.nan
        yield packing


def test_speed_across_the_thickness_of_a_plug():
    part = measure(thickness, falling_plug(range(0, 7, 2)), range(0, 7, 2), SILO, REGION)
    grains, speeds = part.grains.sum(axis=0), part.speeds.sum(axis=0)
    assert (grains > 0).sum() == 8
    np.testing.assert_allclose(speeds[grains > 0] / grains[grains > 0], 0.495, rtol=1e-9)
    assert (part.counts > 0).sum(axis=1).tolist() == [8] * 4


def test_residence_time_of_a_plug():
    """10 d at 0.495 d/tau take 20.2 tau; the end is known to half a step. Grains that started lower do not count."""
    times = range(0, 41, 2)
    part = measure(residence, falling_plug(times), times, SILO, REGION)
    counts = part.counts.sum(axis=0)
    assert counts[0].sum() == 160 * 10 and counts[1].sum() == 0
    for share in residence.QUANTILES.values():
        assert residence.quantile(counts[0], share) == pytest.approx(20.2, abs=2.1)


def test_quantiles():
    counts = np.zeros((2, len(residence.EDGES) - 1))
    counts[0, 3] = 10
    assert residence.quantile(counts, 0.5)[0] == pytest.approx(7) and np.isnan(residence.quantile(counts, 0.5)[1])


@pytest.mark.parametrize("start, known", [(10, False), (24, True)])
def test_residence_times_that_the_run_cuts_off_are_unknown(start, known):
    """Grains that leave from 10 tau on may have stayed for longer than 10 tau, but not those that leave from 24 tau on for 20 tau."""
    times = np.arange(0, 41, 2.0)
    run = SimpleNamespace(times=times, measured={"residence": measure(residence, falling_plug(times), times, SILO, REGION)})
    view = IntervalView(run, np.arange(len(times)), Interval(start, 40.0, "chosen"))
    found = residence.quantities(view)
    assert (found["residence_median_10d"].value is not None) is known
    assert set(found) == {f"residence_{part}_{level}d" for part in ("p16", "median", "p84") for level in (10, 20)}


def test_slices_of_time():
    """Of a run to 61 tau there are two; packing fraction and angle are means over snapshots of a slice, its ends included."""
    times = np.arange(0, 62, 2.0)
    x = np.array([1.25, 3.75])
    slope = np.where(times <= 40, 1.0, 0.0)
    run = SimpleNamespace(
        times=times, badness=np.ones(31), region_grains=np.where(times < 41, 4000, 4400), region=lambda: REGION,
        scene=SimpleNamespace(container=lambda: SILO),
        measured={"free_surface": SimpleNamespace(x=x, times=times, heights=50 + slope[:, None] * x)})
    found = through_time.quantities(IntervalView(run, np.arange(31), Interval(0.0, 60.0, "everything")))
    fraction = math.pi / 6 * 4000 / (12 * 30 * 8)
    assert list(found) == ["packing_fraction_20_40tau", "surface_angle_20_40tau", "packing_fraction_40_60tau", "surface_angle_40_60tau"]
    assert found["packing_fraction_20_40tau"].value == pytest.approx(fraction)
    assert found["packing_fraction_40_60tau"].value == pytest.approx(fraction * (1 + 10 * 1.1) / 11)
    assert found["surface_angle_20_40tau"].value == pytest.approx(45)
    assert found["surface_angle_40_60tau"].value == pytest.approx(45 / 11)


def test_layers_of_a_plug_stay_unmixed():
    """Vertical bonds cross from layer to layer once in ten; what drains is the lowest band first."""
    part = measure(mixing, falling_plug(range(0, 9, 2)), range(0, 9, 2), SILO, REGION)
    assert np.ptp(part.unlike) < 0.02 and 0.02 < part.unlike[0] < 0.06
    lost = part.left[0] - part.left[-1]
    assert lost[:2].sum() == 4 * 160 and lost[3:].sum() == 0


def test_unlike_share():
    points = np.array([[0.0, 0, 20], [1.0, 0, 20], [2.0, 0, 20], [3.0, 0, 20]])
    bonds = find_bonds(points, REGION)
    assert mixing.unlike_share(bonds, np.array([0, 0, 1, 1])) == pytest.approx(1 / 3)
    assert mixing.unlike_share(bonds, np.array([0, 0, -1, -1])) == 0
    assert math.isnan(mixing.unlike_share(bonds, np.full(4, -1)))


def test_arrival_of_a_front():
    """A flux that jumps to 70 at 11 tau reaches half of it between the samples at 10.5 and 11.5 tau."""
    times = np.arange(0, 41, 1.0)
    above = 5000 - 70 * np.maximum(times - 11, 0)
    when, slope = front.arrival(times, above, 70)
    assert when == pytest.approx(11, abs=0.01) and slope == pytest.approx(70, rel=0.01)
    assert math.isnan(front.arrival(times, np.full(41, 5000), 70)[0])
    ramp = 5000 - np.cumsum(times)
    assert front.arrival(times, ramp, 20)[0] == pytest.approx(9.5)


@pytest.mark.parametrize("shape, fano", [(None, 1.0), (4, 0.25)])
def test_fano_factor_and_its_error(shape, fano):
    """Counts of a Poisson process, and of one whose waiting times are sums of four: their Fano factor is 1/4. Two bootstrapped
    errors of 26 counts cover the truth nearly as often as they should for so skewed a statistic: 75 to 99 %."""
    rng = np.random.default_rng(12)
    covered, found = 0, []
    times = np.arange(40, 92, 2.0) + 1
    for _ in range(200):
        waiting = rng.exponential(1 / 70, 5000) if shape is None else rng.gamma(shape, 1 / (70 * shape), 5000)
        counts = np.histogram(np.cumsum(waiting), np.arange(0, 53, 2.0))[0].astype(float)
        sums = block_sums(times, np.column_stack([counts, counts**2, np.ones(26)]), (40, 92))
        found.append(fluctuations.fano_factor(sums.sum(axis=0)))
        covered += abs(found[-1] - fano) < 2 * bootstrap_error(sums, fluctuations.fano_factor)
    assert np.mean(found) == pytest.approx(fano, rel=0.08)
    assert 0.75 < covered / 200 < 0.99


def test_error_of_a_median_covers_the_truth():
    """Residence times of 140 grains in 2 tau that share a slow swing of 6 %: two bootstrapped errors of 26 samples cover the
    true median in 78 to 97 % of 200 runs."""
    rng = np.random.default_rng(21)
    times = np.arange(40, 92, 2.0) + 1
    covered = 0
    for _ in range(200):
        swing = np.repeat(rng.normal(1, 0.06, 13), 2)
        counts = np.array([np.histogram(common * rng.gamma(4, 5, 140), residence.EDGES)[0] for common in swing])
        sums = block_sums(times, counts.astype(float), (40, 92))
        median = residence.quantile(sums.sum(axis=0), 0.5)
        covered += abs(median - 18.32) < 2 * bootstrap_error(sums, lambda some: residence.quantile(some, 0.5))
    assert 0.78 < covered / 200 < 0.97


def test_history():
    history = History(2.0)
    packings = [np.array([[0.0, 0, 1]])] * 5
    for snapshot in make_snapshots(packings, [0, 2, 4, 14, 16.01], SILO, REGION):
        history.add(snapshot)
        if snapshot.time == 14:
            assert history.previous.time == 4 and history.earlier(2.0) is None
    assert history.first.time == 0 and history.earlier(2.0).time == 14


def test_index_of():
    snapshot = next(make_snapshots([np.array([[0.0, 0, 1], [np.nan] * 3, [0, 0, 3]])], [0], SILO, REGION))
    np.testing.assert_array_equal(snapshot.index_of(np.array([1, 2, 3, 9])), [0, -1, 1, -1])
