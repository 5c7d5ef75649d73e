# SPDX-License-Identifier: GPL-2.0-or-later
"""Packing fraction by volume, what stands still, mixing and residence in hoppers, on packings and flows that are known."""

import dataclasses

import numpy as np
import pytest

from spot_analysis.statistics import axial_flow
from spot_analysis.statistics.axial_mixing import mixing
from spot_analysis.statistics.axial_packing import fractions_of_layers
from spot_analysis.statistics.passages import Snapshot
from spot_analysis.statistics.sphere_parts import room, volume_inside
from spot_analysis.statistics.standing import stagnant_layer, still_share
from synthetic import fcc
from test_hopper import SCENE, falling_frames  # lengths of d: outlet 4, cylinder 12, cone 10 high

CONE = SCENE.radius_at


def snapshot(positions, time=0.0, ids=None):
    return Snapshot(time, np.arange(len(positions)) if ids is None else ids, positions, np.zeros(len(positions), dtype=int))


def test_parts_of_a_grain():
    """Inside, cut at a height, cut by an upright wall far away, and by both; outside."""
    far = 1000.0
    places = np.array([[0, 0, 5.0], [0, 0, 0], [0, 0, 0.25], [far, 0, 5], [0, far, 10], [0, 0, -0.5], [far + 0.5, 0, 5]])
    cap = np.pi * 0.25**2 * (1.5 - 0.25) / 3  # of a height of 1/4
    expected = [np.pi / 6, np.pi / 12, np.pi / 6 - cap, np.pi / 12, np.pi / 24, 0, 0]
    assert volume_inside(places, 0.0, 10.0, lambda z: np.full_like(z, far)) == pytest.approx(expected, abs=2e-4)


def test_parts_of_grains_in_a_cone_by_points_at_random():
    """200,000 points in each grain: 5 standard errors are below 0.003."""
    draws = np.random.default_rng(3)
    points = draws.uniform(-0.5, 0.5, (400000, 3))
    points = points[(points**2).sum(axis=1) < 0.25]
    places = np.stack([draws.uniform(3, 12, 40), np.zeros(40), draws.uniform(1.5, 12.5, 40)], axis=1)
    found = volume_inside(places, 2.0, 12.0, CONE)
    for place, volume in zip(places, found):
        x, y, z = (points + place).T
        assert volume == pytest.approx(np.pi / 6 * np.mean((z > 2) & (z < 12) & (np.hypot(x, y) < CONE(z))), abs=0.003)
    assert (found > 0.52).sum() > 5 and ((found > 0.01) & (found < 0.51)).sum() > 5


def test_room_of_a_cone_under_a_cylinder():
    frustum = np.pi * 10 / 3 * (4**2 + 4 * 12 + 12**2)
    assert room(0.0, 15.0, CONE, (10.0,)) == pytest.approx(frustum + 5 * np.pi * 144)


def hopper_of(points):
    """Those of the points that fit between the walls of the hopper: half a diameter off them."""
    axis, z = np.hypot(points[:, 0], points[:, 1]), points[:, 2]
    slope = 8 / 10
    return points[(axis + 0.5 * np.sqrt(1 + slope**2) < 4 + slope * z) & (axis < 11.5) & (z > 0.5)]


def test_packing_fraction_of_a_crystal():
    """In the core it is pi / sqrt(18) of spheres that touch, times 0.8. From wall to wall it is what fits."""
    spacing = 0.8 ** (-1 / 3)
    points = fcc((18, 18, 22), spacing)
    points = hopper_of(points - [*points.max(axis=0)[:2] / 2, 0])
    found = fractions_of_layers(snapshot(points), SCENE, (5.0, 15.0))
    assert found[2] == pytest.approx(0.8 * np.pi / np.sqrt(18), rel=0.005)
    for height, fraction in zip((5.0, 15.0), found):
        draws = np.random.default_rng(1)  # points in the layer, and whether a grain is there
        places = draws.uniform((-12, -12, height - 2), (12, 12, height + 2), (60000, 3))
        places = places[np.hypot(places[:, 0], places[:, 1]) < CONE(places[:, 2])]
        near = points[np.abs(points[:, 2] - height) < 2.6]
        taken = np.array([((near - place)**2).sum(axis=1).min() < 0.25 for place in places[:8000]])
        assert fraction == pytest.approx(taken.mean(), abs=0.02)  # 4 standard errors
        assert 0.45 < fraction < found[2]


def test_grains_of_a_layer_are_all_of_its_volume():
    """Nothing is cut: so many grains of pi/6."""
    draws = np.random.default_rng(2)
    count, turn = 300, draws.uniform(0, 2 * np.pi, 300)
    axis, z = draws.uniform(0, 9, count), draws.uniform(13.5, 16.5, count)
    points = np.stack([axis * np.cos(turn), axis * np.sin(turn), z], axis=1)
    lid = np.stack([*np.meshgrid(np.arange(-12.0, 12), np.arange(-12.0, 12)), np.full((24, 24), 40.0)], axis=-1).reshape(-1, 3)
    assert fractions_of_layers(snapshot(np.vstack([points, lid])), SCENE, (15.0,))[0] == pytest.approx(300 / 6 / (4 * 144))


def test_layers_above_the_surface_are_unknown():
    """A crater that comes down into a layer is no loose packing."""
    points = hopper_of(np.random.default_rng(1).uniform((-12, -12, 0), (12, 12, 25), (20000, 3)))
    crater = points[points[:, 2] < 12 + np.hypot(points[:, 0], points[:, 1])]
    low, high, core = fractions_of_layers(snapshot(crater), SCENE, (5.0, 15.0))
    assert np.isfinite(low) and np.isnan(high) and np.isnan(core)
    assert np.isfinite(fractions_of_layers(snapshot(points), SCENE, (5.0, 15.0))).all()
    assert np.isnan(fractions_of_layers(snapshot(points[:0]), SCENE, (5.0,))).all()


def test_the_core_of_a_narrow_cylinder_ends_at_its_wall():
    """One of 6 d is narrower than the core of others; grains fill it evenly."""
    narrow = dataclasses.replace(SCENE, cylinder_radius=12.0, cone_height=4.0)
    frames = falling_frames(lambda r: 0.5 + 0 * r)  # 12 d wide
    for frame in frames:
        frame.positions[:, :2] /= 2
    found = axial_flow.measure(frames, narrow, 4, 24)
    for name in ("packing_fraction", "volume_fraction_core"):
        assert found[name][0] == pytest.approx(4000 / 6 / 40 / 36, rel=0.1), name


def test_what_stands_still_at_the_wall():
    """Grains fall at 0.5 d/tau up to 7 d from the axis, and not at all beyond."""
    frames = falling_frames(lambda r: 0.5 * (r < 7.0), count=20000)
    found = axial_flow.measure(frames, SCENE, 4, 24)
    assert found["stagnant_layer_15d"][0] == pytest.approx(12 - 7, abs=0.6)
    assert found["stagnant_layer_5d"][0] == pytest.approx(8 - 7, abs=0.6)
    # Of 40 d; up to 7 d from the axis 2 d less.
    moving = 49 * 38
    assert found["still_share"][0] == pytest.approx(1 - moving / (moving + (144 - 49) * 40), abs=0.02)


def test_mass_flow_has_no_stagnant_layer_and_rest_no_width():
    pair = [snapshot(frame.positions / 2, time, frame.ids) for time, frame in enumerate(falling_frames(lambda r: 0.5 + 0 * r)[:2])]
    assert stagnant_layer([pair], 15.0, 12.0)[0] == 0
    still = (pair[0], dataclasses.replace(pair[0], time=2.0))
    assert np.isnan(stagnant_layer([still], 15.0, 12.0)[0]) and still_share(*still) == 1
    assert np.isnan(stagnant_layer([still], 200.0, 12.0)[0])


def test_mixing_of_halves():
    """Halves keep apart, are shuffled, or half of each changes place."""
    draws = np.random.default_rng(5)
    points = draws.uniform((-8, -8, 0), (8, 8, 32), (20000, 3))
    start = snapshot(points)
    kept = mixing(start, start)
    assert kept["lacey_upper_lower_end"] == kept["lacey_upper_lower_start"] == pytest.approx(0, abs=0.02)  # 16 d is an edge of cells
    assert 0.1 < kept["lacey_inner_outer_start"] < 0.6  # cells lie across the circle
    shuffled = mixing(start, snapshot(draws.permutation(points)))
    assert shuffled["lacey_upper_lower_end"] == pytest.approx(1, abs=0.01)
    assert shuffled["lacey_inner_outer_end"] == pytest.approx(1, abs=0.01)
    turned = points.copy()
    swap = draws.random(len(points)) < 0.25
    turned[swap, 2] = 32 - turned[swap, 2]  # shares of 1/4 and 3/4: (1/4 - 1/16) / (1/4)
    assert mixing(start, snapshot(turned))["lacey_upper_lower_end"] == pytest.approx(0.75, abs=0.02)
    assert np.isnan(mixing(start, snapshot(points[:5]))["lacey_upper_lower_end"])
    assert np.isnan(mixing(snapshot(points[:0]), start)["lacey_upper_lower_end"])


def test_quantiles_of_residence():
    """Grains of three speeds take 5, 10 and 20 tau from 5 d, and are 55, 25 and 20 % of what leaves."""
    frames = falling_frames(lambda r: np.select([r < 6.5, r < 9.0], [1.0, 0.5], 0.25), times=range(0, 41, 2), count=12000)
    early, late = axial_flow.measure(frames, SCENE, 10, 38), axial_flow.measure(frames, SCENE, 24, 38)
    assert late["residence_p16_5d"][0] == pytest.approx(5, abs=1.1)
    assert late["residence_median_5d"][0] == pytest.approx(5, abs=1.1)
    assert late["residence_p84_5d"][0] == pytest.approx(20, abs=1.1)
    assert np.isnan(early["residence_p84_5d"][0])  # longer than the run was by then
