# SPDX-License-Identifier: GPL-2.0-or-later
"""Choice of snapshots, outflow and steadiness, density drop, front, and grains in a spot."""

import numpy as np
import pytest
from spot_analysis import calibration_flow as flow
from spot_analysis import calibration_spot_grains as spot_grains
from spot_analysis import calibration_tracks as tracks_module
from spot_analysis.calibration_estimate import CalibrationError, Estimate
from spot_analysis.calibration_front import measure_front
from spot_analysis.calibration_tracks import Tracks, choose_snapshots, find_core, surface_height
from spot_analysis.container import Container

SILO = Container(25.0, 4.0, 4.0)
TIMES = np.arange(40, 92.1, 2.0)


def plug(rate=70.0, shape=lambda time: 1.0, missing=400, height=100.0, above=1.0):
    """A column of points that falls at once, ``rate`` points a tau through z = 0; ``missing`` fewer in the slab than at rest.

    shape : time -> factor of the rate; above : factor of the flow through z > 30 d
    """
    rng = np.random.default_rng(0)
    points = rng.uniform([-25, -4, 0], [25, 4, 0], (int(440 * (height + 20)), 3))
    points[:, 2] = rng.permutation(np.linspace(-20, height, len(points)))
    at_rest = np.vstack([points, rng.uniform([-25, -4, 50], [25, 4, 70], (missing, 3))])
    fallen = np.concatenate([[0], np.cumsum([2 * rate / 440 * shape(time) for time in TIMES[1:]])])
    share = np.where(points[:, 2] > 30, above, 1.0)
    positions = np.array([points - np.outer(share, [0, 0, drop]) for drop in fallen])
    positions[positions[..., 2] < -10] = np.nan
    early = np.concatenate([[0.0], TIMES])
    return Tracks(SILO, TIMES, positions, at_rest, early, [at_rest[:, 2], *positions[..., 2]])


def test_longest_stretch_of_snapshots():
    times = np.concatenate([np.arange(0, 93, 2.0), np.arange(100, 200, 10.0), np.arange(200, 305, 2.0)])
    assert times[choose_snapshots(times)].tolist() == np.arange(200, 305, 2.0).tolist()
    assert times[choose_snapshots(times, 40, 92)].tolist() == TIMES.tolist()
    finer = np.arange(0, 80, 0.5)
    assert finer[choose_snapshots(finer, 40)].tolist() == np.arange(40, 80, 2.0).tolist()


def test_too_few_snapshots_are_refused():
    with pytest.raises(CalibrationError, match="span 10 tau, but 24 are needed"):
        choose_snapshots(np.arange(0, 51, 2.0))
    with pytest.raises(CalibrationError, match="span 0 tau"):
        choose_snapshots(np.array([0.0, 2.0]))
    with pytest.raises(CalibrationError, match="no snapshot 2 tau after that at 92 tau"):
        choose_snapshots(np.concatenate([TIMES, np.arange(100, 200, 10.0)]), 40)
    with pytest.raises(CalibrationError, match="no snapshot 2 tau after that at 40 tau"):
        choose_snapshots(np.arange(0, 100, 5.0), 40)


def test_core_lies_below_the_surface():
    assert find_core(plug()).top == 66
    low = plug(height=65.0)
    surface = surface_height(low.frame(-1), SILO)
    assert find_core(low).top == pytest.approx(surface - tracks_module.SURFACE_MARGIN)
    with pytest.raises(CalibrationError, match="the packing is too low: its surface is at z = 3[0-9] d at 92 tau"):
        find_core(plug(height=45.0))


def test_known_outflow_and_drop():
    tracks = plug()
    outflow, drop = flow.measure_outflow(tracks), flow.measure_drop(tracks)
    assert outflow.value == pytest.approx(70, abs=max(3 * outflow.error, 0.5))
    assert drop.value == pytest.approx(400, abs=5)


@pytest.mark.parametrize("options, message", [
    ({"rate": 0.0}, "no steady flow: 0 .* grains a tau leave between 40 and 92 tau"),
    ({"shape": lambda time: (time - 30) / 30}, "after; choose a later interval"),
    ({"above": 0.5}, "pass z = 50 d, but"),
])
def test_unsteady_flow_is_refused(options, message):
    with pytest.raises(CalibrationError, match=message):
        flow.measure_outflow(plug(**options))


def test_density_that_does_not_drop_is_refused():
    with pytest.raises(CalibrationError, match="density does not drop"):
        flow.measure_drop(plug(missing=0, rate=1e-6))
    with pytest.raises(CalibrationError, match="within the slab of 50 to 70 d"):
        flow.measure_drop(plug(height=65.0))


def test_front_of_known_speed():
    """Points start to fall when the front, 3 d/tau, has passed them."""
    points = np.random.default_rng(0).uniform(0, 110, 48400)
    times = np.arange(0, 42, 2.0)
    heights = [points - 70 / 440 * np.maximum(times[step] - points / 3, 0) for step in range(len(times))]
    tracks = Tracks(SILO, TIMES, np.empty((0, 0, 3)), np.empty((0, 3)), times, heights)
    front = measure_front(tracks, 70.0)
    assert front.speed == pytest.approx(3.0, rel=0.03) and front.error < 0.2
    thinned = Tracks(SILO, TIMES, np.empty((0, 0, 3)), np.empty((0, 3)), times[[0, 5, 10]], heights[::10])
    assert measure_front(thinned, 70.0) is None


def test_spots_stay_where_spots_may_go():
    places = spot_grains.spot_places(np.random.default_rng(0), 20000, SILO, (10.0, 100.0), 1.0)
    assert np.abs(places[:, 0]).max() <= 24 and np.abs(places[:, 1]).max() <= 3
    assert places[:, 2].min() >= 15 and places[:, 2].max() <= 60
    narrow = spot_grains.spot_places(np.random.default_rng(0), 20000, SILO, (0.0, 25.0), 1.0)
    assert narrow[:, 0].std() == pytest.approx(5, rel=0.03)


def test_walls_cut_the_spots():
    """Trap of 2006's 81.7 grains: centres d from walls 8 d apart leave 0.957 of the sphere."""
    assert spot_grains.cut_share(SILO, 2.6, 1.0) == pytest.approx(0.957, abs=5e-4)
    assert spot_grains.cut_share(SILO, 1.0, 1.0) == 1


def test_grains_in_a_spot_against_the_formula():
    tracks = plug()
    table = spot_grains.measure_spot_grains(tracks, (2.5, 0.0), 1.0)
    for radius in (2.0, 2.6, 3.1):
        exact = Estimate(np.array(radius), np.full(1000, radius))
        found = spot_grains.grains_within(table, exact)
        volume = 4 / 3 * np.pi * radius**3
        assert found.value == pytest.approx(440 / 400 * volume * spot_grains.cut_share(SILO, radius, 1.0), rel=0.02)
        scattered = Estimate(np.array(radius), radius * (1 + 0.01 * np.random.default_rng(0).normal(size=1000)))
        assert spot_grains.grains_within(table, scattered).error > 0.02 * found.value  # grows as R^3 and less at the walls
