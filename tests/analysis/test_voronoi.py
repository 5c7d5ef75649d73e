# SPDX-License-Identifier: GPL-2.0-or-later
"""Voronoi cells whose volume is known, and against scipy's cells one by one."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial import ConvexHull, Voronoi
from spot_analysis.reading.container import Container
from spot_analysis.statistics import voronoi, voronoi_cells
from spot_analysis.statistics.interval import Interval
from spot_analysis.statistics.interval_view import IntervalView
from spot_analysis.statistics.region import Region

from synthetic import fcc, hcp, measure, middle_of, sequential_packing

NO_HOLE = Container(5, 4, 1e-9)


@pytest.mark.parametrize("points, volume", [
    (np.mgrid[0:8, 0:8, 0:8].reshape(3, -1).T.astype(float), 1.0),
    (fcc((6, 6, 6), 1.0), 1 / math.sqrt(2)), (hcp((8, 5, 5), 1.0), 1 / math.sqrt(2)),
    (np.vstack([np.mgrid[0:7, 0:7, 0:7].reshape(3, -1).T, np.mgrid[0:6, 0:6, 0:6].reshape(3, -1).T + 0.5]), 0.5),
], ids=["simple cubic", "fcc", "hcp", "bcc"])
def test_lattices(points, volume):
    """All their neighbours lie on spheres, so many tetrahedra are flat."""
    inner = (np.abs(points - (points.max(axis=0) + points.min(axis=0)) / 2) < np.ptp(points, axis=0) / 2 - 1.6).all(axis=1)
    assert inner.sum() > 20
    np.testing.assert_allclose(voronoi_cells.cell_volumes(points)[inner], volume, rtol=1e-9)


def box_of_grains(seed=0):
    """Random grains that fill the box of NO_HOLE up to 8 d."""
    return sequential_packing(np.random.default_rng(seed), 480, [-5, -4, 0], [5, 4, 8], 0.9)


@pytest.mark.parametrize("seed", range(3))
def test_cells_equal_those_of_scipy(seed):
    points = voronoi_cells.with_mirror_images(box_of_grains(seed), NO_HOLE)
    volumes = voronoi_cells.cell_volumes(points)
    diagram = Voronoi(points)
    compared = 0
    for grain in np.flatnonzero((points[:480, 2] < 5))[:150]:
        corners = diagram.regions[diagram.point_region[grain]]
        if -1 not in corners:
            assert volumes[grain] == pytest.approx(ConvexHull(diagram.vertices[corners]).volume, rel=1e-9)
            compared += 1
    assert compared > 100


def test_cells_fill_the_box():
    """Grains and their images in a lid close all cells, which then fill 10 d x 8 d x 8 d."""
    points = box_of_grains()
    lid = points * [1, 1, -1] + [0, 0, 16]
    closed = voronoi_cells.with_mirror_images(np.vstack([points, lid]), NO_HOLE, reach=4)
    volumes = voronoi_cells.cell_volumes(closed)[:480]
    assert volumes.min() > 0.3 and volumes.sum() == pytest.approx(640, rel=1e-9)
    inside = voronoi_cells.cells_in_container(np.vstack([points, lid]), NO_HOLE)[:480]
    small = volumes < 1.5
    np.testing.assert_allclose(inside[small], volumes[small], rtol=1e-9)
    assert np.all(np.isinf(inside[volumes > voronoi_cells.OPEN]))


def test_mirror_images_keep_out_of_the_orifice():
    points = np.array([[0.0, 0, 0.5], [10.0, 0, 0.5], [24.5, 3.5, 20]])
    images = voronoi_cells.with_mirror_images(points, Container(25, 4, 4))[3:]
    assert {tuple(image) for image in images} == {(10.0, 0.0, -0.5), (25.5, 3.5, 20.0), (24.5, 4.5, 20.0),
                                                  (25.5, 4.5, 20.0)}


def test_map_and_mean_of_a_crystal():
    """FCC of spacing 1.05 d: mean pi/6 over the cell away from walls, whose cells are wider by half a layer."""
    points = middle_of(fcc((12, 5, 36), 1.05)) + [0, 0, 0.5]
    container = Container(float(points[:, 0].max()) + 0.5, float(points[:, 1].max()) + 0.5, 1e-9)
    part = measure(voronoi, [points] * 3, [0, 2, 10], container, Region(4, 15, 40))
    assert part.times.tolist() == [0, 10]
    bulk = math.pi / 6 / (1.05**3 / math.sqrt(2))
    maps = math.pi / 6 * part.map_grains.sum(axis=0) / np.maximum(part.map_volumes.sum(axis=0), 1e-9)
    assert 0.9 * bulk < part.mean[0] <= bulk and part.mean[0] == part.mean[1]
    assert maps[4, 10] == pytest.approx(part.mean[0], rel=0.03)
    few = measure(voronoi, [points[:3]], [0], container, Region(4, 15, 40))
    assert math.isnan(few.mean[0]) and few.map_grains.sum() == 0


def mapped(axis, shoulder, top):
    """A view of six maps of a silo with walls at 25 d: packing fractions on the axis and beyond |x| = 11 d, filled up to ``top``."""
    x, z = np.linspace(-25, 25, 26), np.arange(0, 72, 2.0)
    middle = np.abs(x[1:] + x[:-1]) / 2
    fraction = np.where(middle < 11, axis, shoulder)[:, None] + 0 * z[:-1]
    grains = np.where(z[1:] <= top, 36, 3) * np.ones((6, 25, 1), dtype=np.int64)
    times = 40 + 10.0 * np.arange(6)
    part = SimpleNamespace(x_edges=x, z_edges=z, times=times, map_grains=grains, map_volumes=voronoi.GRAIN * grains / fraction,
                           mean=np.full(6, axis), spread=np.full(6, 0.05))
    run = SimpleNamespace(times=times, measured={"voronoi": part})
    return IntervalView(run, np.arange(6), Interval(40.0, 90.0, "steady"))


def test_axis_less_shoulder():
    assert voronoi.quantities(mapped(0.582, 0.571, 80))["packing_axis_less_shoulder"].value == pytest.approx(0.011)
    assert voronoi.quantities(mapped(0.582, 0.571, 20))["packing_axis_less_shoulder"].value is None  # too low for any height


def test_profiles_are_compared_where_both_are_filled():
    one, other = mapped(0.582, 0.571, 80), mapped(0.588, 0.5, 40)
    heights = np.flatnonzero(np.isfinite(voronoi.axis_profile(one)))
    assert heights.tolist() == list(range(2, 35))  # 4-70 d
    assert np.isfinite(voronoi.axis_profile(other)).sum() == 18  # 4-40 d
    assert voronoi.between(one, other)["packing_profile_rms"].value == pytest.approx(0.006)
    assert voronoi.between(one, mapped(0.6, 0.6, 2))["packing_profile_rms"].value is None
