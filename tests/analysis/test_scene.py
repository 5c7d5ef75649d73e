# SPDX-License-Identifier: GPL-2.0-or-later
"""Scene files and options."""

import json
import math

import numpy as np
import pytest
from spot_analysis.base.errors import SceneError
from spot_analysis.reading.scene import KEYS, NUMBERS, ORIGIN, load_scene

from synthetic import SCENE


def write(folder, values):
    (folder / "scene.json").write_text(values if isinstance(values, str) else json.dumps(values))
    return str(folder)


def test_reads_the_file_beside_the_dumps(tmp_path):
    source = write(tmp_path, {**SCENE, "diameter": 0.003, "gravity": 9.81, "timestep": 1.75e-6, "grains": 55000})
    for dumps in (source, f"{source}/run.*.dump"):
        scene = load_scene(dumps)
        assert scene.grains == 55000
        assert scene.tau == pytest.approx(math.sqrt(0.003 / 9.81))
        assert scene.time(20000) == pytest.approx(2.0, rel=1e-3)
        assert scene.container().half_depth == pytest.approx(4 / 0.003)


def test_options_win_over_the_file_and_suffice_without_it(tmp_path):
    assert load_scene(write(tmp_path, SCENE), overrides={"diameter": 2.0, "gravity": None}).diameter == 2.0
    (tmp_path / "bare").mkdir()
    assert load_scene(str(tmp_path / "bare"), overrides={key: SCENE[key] for key in NUMBERS}).diameter == 1.0


@pytest.mark.parametrize("key", NUMBERS)
def test_missing_key_is_named(tmp_path, key):
    source = write(tmp_path, {k: v for k, v in SCENE.items() if k != key})
    with pytest.raises(SceneError, match=f"scene key '{key}' is missing in"):
        load_scene(source)


@pytest.mark.parametrize("name", ["absent", "absent.npz"])
def test_no_source(tmp_path, name):
    with pytest.raises(SceneError, match="absent.*: no such file or folder"):
        load_scene(f"{tmp_path}/{name}", overrides={key: SCENE[key] for key in NUMBERS})


def test_no_file_is_named(tmp_path):
    with pytest.raises(SceneError, match="'diameter' is missing .no .*scene.json"):
        load_scene(str(tmp_path))


@pytest.mark.parametrize("value", [0, -1, "3 mm", None, True, math.nan, math.inf])
def test_bad_value_is_named(tmp_path, value):
    with pytest.raises(SceneError, match="'timestep' must be a positive number"):
        load_scene(write(tmp_path, {**SCENE, "timestep": value}))


@pytest.mark.parametrize("text", ["{", "[1]"])
def test_bad_file(tmp_path, text):
    with pytest.raises(SceneError, match="scene.json"):
        load_scene(write(tmp_path, text))


def test_format(tmp_path):
    """A file without one has the first."""
    assert load_scene(write(tmp_path, {"format": 1, **SCENE})) == load_scene(write(tmp_path, SCENE))
    for form in (2, 0, "1", True, None):
        with pytest.raises(SceneError, match=f"scene.json: 'format' is {json.dumps(form)}, but 1 is the newest") as error:
            load_scene(write(tmp_path, {**SCENE, "format": form}))
        assert "\n" not in str(error.value)


@pytest.mark.parametrize("key", ["shape", "half_width", "Diameter", ""])
def test_unknown_key_is_named_with_those_that_are_allowed(tmp_path, key):
    with pytest.raises(SceneError, match=f"scene.json: unknown scene key '{key}'; allowed are {', '.join(KEYS)}$"):
        load_scene(write(tmp_path, {**SCENE, key: 1}))


def test_key_that_stands_there_twice(tmp_path):
    text = json.dumps(SCENE)[:-1] + ', "gravity": 9.81}'
    with pytest.raises(SceneError, match="scene.json: .*key 'gravity' stands there twice"):
        load_scene(write(tmp_path, text))


@pytest.mark.parametrize("key", ORIGIN)
@pytest.mark.parametrize("value", ["0", None, False, math.nan, -math.inf])
def test_bad_origin_is_named(tmp_path, key, value):
    with pytest.raises(SceneError, match=f"'{key}' must be a number"):
        load_scene(write(tmp_path, {**SCENE, key: value}))


def test_origin_of_time_and_space(tmp_path):
    """In the dumps' units; the orifice opens at 3.5 s, on the axis (0.5, -1, 4) m."""
    scene = load_scene(write(tmp_path, {**SCENE, "diameter": 0.5, "gravity": 2, "opening_time": 3.5, "axis_x": 0.5, "axis_y": -1,
                                        "base_z": 4}))
    assert scene.time(350) == pytest.approx(0, abs=1e-12)
    assert scene.time(450) == pytest.approx(1 / 0.5)
    np.testing.assert_allclose(scene.positions(np.array([[0.5, -1, 4], [1, -1, 5]])), [[0, 0, 0], [1, 0, 2]])
