# SPDX-License-Identifier: GPL-2.0-or-later
"""Statistics and pictures of arrays: the docstring's example, the numbers of dumps, packings of spotcore, refusals."""

import doctest

import numpy as np
import pytest

from conftest import ANALYSIS
from synthetic import SCENE, plug, write_plug_flow

import spot_analysis
from spot_analysis.base.errors import AnalysisError
from spot_analysis.commands import arrays
from spot_analysis.reading.packing_file import read_packing
from spot_analysis.reading.scene import load_scene
from spot_analysis.statistics import run_statistics
from spot_analysis.statistics.measuring import measure_dumps

BOX = {key: value for key, value in SCENE.items() if key != "timestep"}
HOPPER = {"diameter": 0.003, "gravity": 9.81, "orifice_radius": 0.012, "cylinder_radius": 0.03, "cone_height": 0.045}
HOPPER_AS_BOX = {"diameter": 0.003, "gravity": 9.81, "half_width_x": 0.03, "half_depth_y": 0.03, "orifice_radius": 0.012}
ONE = np.array([[0.0, 0.0, 1.0]])


def test_the_example():
    found = doctest.testmod(arrays)
    assert found.failed == 0 and found.attempted > 5


def test_arrays_have_the_numbers_of_dumps(tmp_path):
    times = np.arange(0, 10, 2)
    folder = write_plug_flow(tmp_path / "plug", 2.0, times)
    dumped = measure_dumps(folder, load_scene(folder), warn=lambda line: None)
    start = plug()
    left = [start[:, 2] - 0.99 * time > 0 for time in times]
    backwards = [np.flatnonzero(one)[::-1] for one in left]  # in any order
    run = spot_analysis.measure(times, [ids + 1 for ids in backwards],
                                [start[ids] - [0, 0, 0.99 * time] for ids, time in zip(backwards, times)], BOX)
    assert np.array_equal(run.above, dumped.above) and np.allclose(run.profile_sums, dumped.profile_sums, rtol=1e-9)
    assert spot_analysis.numbers(run)["outflow"].value == pytest.approx(160)
    run.save(tmp_path / "a.npz")
    assert np.array_equal(run_statistics.load(tmp_path / "a.npz").grains, run.grains)


def test_pictures():
    grains = read_packing(str(ANALYSIS.parent / "examples" / "own-hopper" / "packing.data.gz"))
    image = spot_analysis.picture(grains.positions, HOPPER, height=300)
    assert image.height == 300
    assert np.asarray(spot_analysis.picture(grains.positions, {"diameter": 0.003, "gravity": 9.81}, height=300)).shape != np.asarray(image).shape
    colours = {heights: np.asarray(spot_analysis.picture(grains.positions, HOPPER, heights=np.full(8000, heights), height=300)).reshape(-1, 3)
               for heights in (0.0, 0.04)}
    assert not np.array_equal(colours[0.0], colours[0.04])


def test_a_packing_of_spotcore():
    spotcore = pytest.importorskip("spotcore")
    grains = read_packing(str(ANALYSIS.parent / "examples" / "own-hopper" / "packing.data.gz"))
    packing = spotcore.Packing(grains.positions, 0.0015)
    assert spot_analysis.picture(packing.positions, HOPPER, height=200).height == 200
    run = spot_analysis.measure([0.0], [packing.ids], [packing.positions], HOPPER_AS_BOX)
    assert spot_analysis.numbers(run)["grains_initial"].value == 8000


@pytest.mark.parametrize("times, ids, positions, message", [
    ([], [], [], "times: must be one or more numbers"),
    ([1, 0], [[1], [1]], [ONE, ONE], "times: must be"),
    ([0, 1], [[1]], [ONE, ONE], "2 times, 1 arrays of ids, 2 of positions"),
    ([0], [[1, 2]], [ONE], r"ids\[0\]: must be 1 whole numbers"),
    ([0], [[1.5]], [ONE], r"ids\[0\]: must be 1 whole numbers"),
    ([0], [[3, 3]], [np.vstack([ONE, ONE + 1])], r"ids\[0\]: 3 stands there twice"),
    ([0], [[1]], [[[0.0, 0.0]]], r"positions\[0\]: must be finite numbers .N, 3., but its shape is .1, 2."),
    ([0], [[1]], [ONE * np.nan], r"positions\[0\]: must be finite"),
])
def test_refusals(times, ids, positions, message):
    with pytest.raises(AnalysisError, match=message):
        spot_analysis.measure(times, ids, positions, BOX)


def test_bad_scenes_and_slabs():
    with pytest.raises(AnalysisError, match="scene key 'half_width_x' is missing"):
        spot_analysis.measure([0], [[1]], [ONE], {"diameter": 1, "gravity": 1})
    with pytest.raises(AnalysisError, match="slab: no grain between y = 5 and 6 d"):
        spot_analysis.picture(ONE, BOX, slab=(5, 6))
    with pytest.raises(AttributeError, match="no attribute 'measures'"):
        spot_analysis.measures
