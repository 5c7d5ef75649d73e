# SPDX-License-Identifier: GPL-2.0-or-later
"""Silos that repeat along y, against all images of the grains, and against the same silo seen from elsewhere."""

import dataclasses
import itertools
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from spot_analysis.base.errors import AnalysisError, SceneError
from spot_analysis.reading.container import Container
from spot_analysis.reading.scene import load_scene, scene_of
from spot_analysis.report import comparison, left_out
from spot_analysis.statistics import (bond_angles, bond_order, bonds, cell_imprint, frame_correlation, neighbours, radial_distribution,
                                      run_statistics, velocity_correlation, voronoi_cells)
from spot_analysis.statistics.interval import common_times
from spot_analysis.statistics.interval_view import whole_run
from spot_analysis.statistics.measuring import measure_dumps
from spot_analysis.statistics.region import Region

from synthetic import SCENE, frame_text, sequential_packing, write_text

ANALYSIS = Path(__file__).resolve().parents[2] / "analysis"
PERIOD = 13.0
SILO = Container(10, PERIOD / 2, 3, periodic=True)
REGION = Region(4, 3, 9)
PERIODIC = {**{key: value for key, value in SCENE.items() if key != "half_depth_y"}, "orifice_radius": 3.0, "half_period_y": PERIOD / 2}


def packing(rng, grains=900):
    """A random packing of the cell, some pairs of which overlap through its ends, each grain in some period."""
    points = sequential_packing(rng, grains, [-8, -PERIOD / 2, 0.5], [8, PERIOD / 2, 14], 0.85)
    return points + [0, 1, 0] * rng.integers(-3, 4, (grains, 1)) * PERIOD


def images(points):
    """The points in the cell, (n, 3), and their images in both next ones behind them."""
    inside = points - [0, PERIOD, 0] * np.rint(points[:, 1:2] / PERIOD)
    return np.vstack([inside, *(inside + [0, side * PERIOD, 0] for side in (-1, 1))])


@pytest.mark.parametrize("seed", range(3))
def test_pairs_against_all_images(seed):
    points = packing(np.random.default_rng(seed))
    everywhere, inside = images(points), REGION.contains(points)
    distance = np.linalg.norm(everywhere[:len(points)][:, None] - everywhere, axis=2)
    pairs = neighbours.region_pairs(points, REGION, period=PERIOD)
    seen = distance[inside]
    np.testing.assert_array_equal(radial_distribution.rdf_counts(pairs),
                                  np.histogram(seen[seen > 0], radial_distribution.RDF_EDGES)[0])
    largest = 1 - distance[distance > 0].min()
    assert neighbours.largest_overlap(points, PERIOD) == pytest.approx(largest)
    found = bonds.find_bonds(points, REGION, period=PERIOD)
    of_images = bonds.find_bonds(everywhere, REGION)
    of_images = dataclasses.replace(of_images, inside=of_images.inside & (of_images.grains < len(points)))
    np.testing.assert_array_equal(bond_angles.angle_counts(found), bond_angles.angle_counts(of_images))
    assert len(found.first) < len(of_images.first)  # there they go on beyond the cell
    assert bond_order.crystal_share(found) == bond_order.crystal_share(of_images)


def test_pairs_through_the_ends_of_the_cell_count():
    """Without the period they are missing."""
    points = images(packing(np.random.default_rng(5)))[:900]
    assert neighbours.largest_overlap(points, PERIOD) >= neighbours.largest_overlap(points) > 0
    apart = neighbours.region_pairs(points, REGION), neighbours.region_pairs(points, REGION, period=PERIOD)
    assert apart[1].ends.sum() > 1.1 * apart[0].ends.sum()


def test_correlations_against_all_images():
    rng = np.random.default_rng(1)
    points = packing(rng, 400)
    values, everywhere = rng.normal(size=400), images(points)
    edges = velocity_correlation.EDGES
    distance = np.linalg.norm(everywhere[:400][:, None] - everywhere, axis=2)
    products = values[:, None] * np.tile(values, 3)
    pairs, sums = frame_correlation.pair_sums(points, values, PERIOD)
    expected = np.histogram(distance, edges)[0] / 2, np.histogram(distance, edges, weights=products)[0] / 2
    np.testing.assert_array_equal(pairs, expected[0])
    np.testing.assert_allclose(sums, expected[1], atol=1e-9)
    w = rng.normal(size=(400, velocity_correlation.SIZE))
    np.testing.assert_array_equal(velocity_correlation.frame_sums(points, w, PERIOD)[2], expected[0])


def test_rdf_of_an_ideal_gas_is_1():
    """Within five standard errors of every bin beyond 1 d."""
    points = np.random.default_rng(7).uniform([-8, -PERIOD / 2, 0], [8, PERIOD / 2, 14], (6000, 3))
    counts = radial_distribution.rdf_counts(neighbours.region_pairs(points, Region(3, 5, 9), period=PERIOD))
    inside = Region(3, 5, 9).contains(points).sum()
    rho = 6000 / (16 * PERIOD * 14)
    g = radial_distribution.slab_rdf(counts * (inside / (rho * 6 * 4 * PERIOD)), inside, 1, Region(3, 5, 9), SILO)
    beyond = radial_distribution.RDF_EDGES[:-1] >= 1
    assert (abs(g - 1) < 5 * np.sqrt(2 / np.maximum(counts, 1)) + 0.02)[beyond].all()
    assert g[beyond].mean() == pytest.approx(1, abs=0.02)


def test_cells_against_all_images():
    points = packing(np.random.default_rng(3), 1500)
    volumes = voronoi_cells.cells_in_container(points, SILO)
    expected = voronoi_cells.cells_in_container(images(points), Container(10, 1.5 * PERIOD, 3))[:len(points)]
    closed = np.isfinite(volumes)
    assert closed.sum() > 500
    np.testing.assert_array_equal(closed, np.isfinite(expected))
    np.testing.assert_allclose(volumes[closed], expected[closed], rtol=1e-6)


def test_only_x_has_walls():
    places = np.array([[0, PERIOD, 2], [0, 3.4 * PERIOD, 5], [9.7, 0, 5], [10.2, 0, 5], [0, 2 * PERIOD + 0.5, -4], [0, 6.5, -1], [0, 0, -1]])
    np.testing.assert_array_equal(SILO.outside(places), [False, False, False, True, False, True, False])
    np.testing.assert_allclose(SILO.wall_overlap(places), [0, 0, 0.2, 0.7, 0, 0, 0])
    # over the base, but for the hole, of which there is one in every period
    np.testing.assert_allclose(SILO.wall_overlap(np.array([[0, 5, 0.4], [0, PERIOD - 1, 0.4]])), [0.1, 0])


def write_run(folder, shift=0.0, scene=None, seed=0):
    """Dumps every 2 tau of a dense lattice that falls the faster, the nearer to the axis; y shifted, and each grain in some period."""
    folder.mkdir()
    (folder / "scene.json").write_text(json.dumps(scene or PERIODIC))
    rng = np.random.default_rng(seed)
    start = np.array(list(itertools.product(np.arange(-9, 10) * 1.0, np.arange(13) - 6.0, np.arange(56) + 0.6)))
    start += rng.normal(0, 0.05, start.shape)
    ids, periods = np.arange(1, len(start) + 1), rng.integers(-2, 3, len(start))
    for time in range(0, 12, 2):
        places = start.copy()
        places[:, 2] -= 0.2 * time * np.exp(-start[:, 0]**2 / 20)
        places += rng.normal(0, 0.02, places.shape)
        places[:, 1] += shift + PERIOD * periods * (shift != 0)
        left = places[:, 2] > 0.5
        text = frame_text(time * 100, ids[left], places[left], "id x yu z", extra=[("yu", places[left, 1])]).replace("ff ff ff", "ff pp ff")
        write_text(folder / f"run.{time * 100}.dump", text)
    return str(folder)


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("runs")
    sources = [write_run(folder / "one"), write_run(folder / "shifted", 3.7)]
    return [measure_dumps(source, load_scene(source), warn=lambda text: None) for source in sources]


def test_where_the_cell_begins_is_of_no_account(runs):
    """Nor in which period a grain is: only pictures, of the layer around y = 0, differ."""
    one, other = runs
    for name in run_statistics.ARRAYS:
        if not name.startswith("picture_"):
            np.testing.assert_allclose(getattr(other, name), getattr(one, name), rtol=1e-5, atol=1e-9, err_msg=name)
    for concept, part in one.measured.items():
        for name, array in vars(part).items():
            again = getattr(other.measured[concept], name)
            if name.startswith("map_"):  # between orifice and free surface, where cells are open
                array, again = array[..., 2:25], again[..., 2:25]
            np.testing.assert_allclose(again, array, rtol=1e-4, atol=1e-6, err_msg=f"{concept} {name}")
    assert one.badness[0] > 0 and not one.outside.any()
    assert one.region_grains[0] * np.pi / 6 / (one.region().area() * PERIOD) == pytest.approx(np.pi / 6, rel=0.05)
    assert 0 < one.picture_sizes[0] < 0.1 * one.grains[0]


def test_what_it_cannot_have_is_left_out_by_name(runs, tmp_path):
    reasons = comparison.left_out_of(runs[0])
    told = {name for name, reason in reasons.items() if reason == "the silo repeats along y, where no walls stand"}
    assert told == {"speed_wall_over_middle", "packing_fraction_middle", "packing_wall_over_middle"}
    runs[0].save(tmp_path / "run.npz")
    again = run_statistics.load(tmp_path / "run.npz")
    assert again.scene == runs[0].scene and again.scene.periodic_y
    assert comparison.left_out_of(again).keys() == reasons.keys()
    assert "packing_fraction" not in reasons and "contacts_per_grain" not in reasons and "profile_variance_10d" not in reasons
    assert left_out.summary(reasons)
    assert whole_run(again)


def test_a_report_is_made_of_it(runs, tmp_path):
    for name, one in zip(("dem", "spot"), runs):
        one.save(tmp_path / f"{name}.npz")
    done = subprocess.run([sys.executable, "-B", ANALYSIS / "compare.py", "dem.npz", "spot.npz", "-o", "report"], cwd=tmp_path,
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "the silo repeats along y" in done.stderr
    assert (tmp_path / "report" / "report.html").exists() and not (tmp_path / "report" / "across_thickness.png").exists()
    curves = json.loads((tmp_path / "report" / "comparison.json").read_text())
    assert "velocity_across" not in json.dumps(curves)


def test_walls_and_a_period_are_not_compared(runs):
    walls = scene_of({**SCENE, "orifice_radius": 3.0, "half_depth_y": PERIOD / 2})
    other = run_statistics.RunStatistics(**{**vars(runs[1]), "scene": walls})
    with pytest.raises(AnalysisError, match="along y DEM is periodic, and the other has walls"):
        common_times(runs[0], other)


@pytest.mark.parametrize("values, said", [
    ({**SCENE, "half_period_y": 8.0}, "both 'half_depth_y' and 'half_period_y' are given"),
    ({**PERIODIC, "half_period_y": 5.9}, "'half_period_y' is 5.9, half of a period of 11.8 d, but must be half of 12 d or more"),
    ({**PERIODIC, "half_period_y": -8}, "must be a positive number"),
    ({**PERIODIC, "half_period_x": 8}, "unknown scene key 'half_period_x'"),
])
def test_bad_periods(tmp_path, values, said):
    (tmp_path / "scene.json").write_text(json.dumps(values))
    with pytest.raises(SceneError, match=said):
        load_scene(str(tmp_path))


def test_scene_is_stored_as_it_is_written():
    scene = scene_of(PERIODIC)
    assert scene.container() == Container(10.0, 6.5, 3.0, True)
    assert "half_depth_y" not in scene.as_dict() and "periodic_y" not in scene.as_dict()
    assert scene_of(scene.as_dict()) == scene
    assert "half_period_y" not in scene_of(SCENE).as_dict()


def test_what_is_measured_between_walls_is_refused(tmp_path):
    with pytest.raises(AnalysisError, match="periodic along y"):
        cell_imprint.Measurement(SILO)
    done = subprocess.run([sys.executable, "-B", ANALYSIS / "calibrate.py", write_run(tmp_path / "run")], capture_output=True, text=True)
    assert done.returncode == 1
    assert "the silo is periodic along y, but parameters are measured between walls there" in done.stderr
