# SPDX-License-Identifier: GPL-2.0-or-later
"""Choice of snapshots, outflow and steadiness, density drop, front, and grains in a spot."""

from types import SimpleNamespace

import numpy as np
import pytest
from spot_analysis.calibration import flow, spot_grains
from spot_analysis.calibration.estimate import CalibrationError
from spot_analysis.calibration.front import measure_front
from spot_analysis.calibration.view import choose_snapshots, view_of
from spot_analysis.reading.container import Container

SILO = Container(25.0, 4.0, 4.0)
TIMES = np.arange(40, 92.1, 2.0)


def run_of(times, heights):
    """What is asked of a RunStatistics here; heights : those of the grains in each snapshot."""
    return SimpleNamespace(times=times, count_above=lambda level: np.array([(z > level).sum() for z in heights]))


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
    heights = [points[:, 2] - share * drop for drop in fallen]
    return view_of(run_of(np.concatenate([[0.0], TIMES]), [at_rest[:, 2], *heights]), 40)


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


def test_start_is_needed():
    with pytest.raises(CalibrationError, match="the first snapshot is at t = 40 tau; v_s needs the packing at rest"):
        view_of(run_of(TIMES, []))


def test_known_outflow_and_drop():
    view = plug()
    outflow, drop = flow.measure_outflow(view), flow.measure_drop(view)
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
    front = measure_front(run_of(times, heights), 70.0)
    assert front.speed == pytest.approx(3.0, rel=0.03) and front.error < 0.2
    assert measure_front(run_of(times[[0, 5, 10]], heights[::10]), 70.0) is None


def test_walls_cut_the_spots():
    """Trap of 2006's 81.7 grains: centres d from walls 8 d apart leave 0.957 of the sphere."""
    assert spot_grains.cut_share(SILO, 2.6, 1.0) == pytest.approx(0.957, abs=5e-4)
    assert spot_grains.cut_share(SILO, 1.0, 1.0) == 1


def test_grains_in_a_spot():
    """2006 without walls; and points at random in spheres even in |y| < 3 d between the walls, to 1 %."""
    assert spot_grains.spot_grains(0.579, 2.6, Container(25, 40, 4), 3.0) == pytest.approx(81.7, rel=0.005)
    rng = np.random.default_rng(0)
    points = rng.uniform([-3, -4, -3], [3, 4, 3], (40000, 3))
    centres = np.column_stack([np.zeros(400), np.linspace(-3, 3, 400), np.zeros(400)])
    counted = np.mean([(((points - centre)**2).sum(axis=1) < 2.6**2).sum() for centre in centres])
    fraction = 40000 / 288 * np.pi / 6
    found = spot_grains.spot_grains(np.array([fraction, 2 * fraction]), np.array([2.6, 2.6]), SILO, 1.0)
    np.testing.assert_allclose(found, [counted, 2 * counted], rtol=0.01)
