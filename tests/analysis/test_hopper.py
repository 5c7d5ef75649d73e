# SPDX-License-Identifier: GPL-2.0-or-later
"""What is measured of a round hopper, on flows that are known, and what its command says of input that does not fit."""

import dataclasses
import json

import numpy as np
import pytest

from conftest import script
from spot_analysis.base.errors import SceneError
from spot_analysis.reading.axial_scene import AxialScene, load_axial_scene
from spot_analysis.reading.frame import Frame
from spot_analysis.statistics import axial_flow
from synthetic import write_frames

SCENE = AxialScene(diameter=2.0, gravity=2.0, timestep=0.5, orifice_radius=8.0, cylinder_radius=24.0, cone_height=20.0)  # tau = 1


def falling_frames(speed_at, times=range(0, 25, 2), count=4000):
    """Frames of grains spread evenly over 12 d by 40 d, each of which falls at speed_at(r), d/tau; gone below -2 d."""
    draws = np.random.default_rng(1)
    radius, angle, height = 12 * np.sqrt(draws.random(count)), 2 * np.pi * draws.random(count), 40 * draws.random(count)
    frames = []
    for time in times:
        z = height - speed_at(radius) * time
        there = z > -2
        places = 2.0 * np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=1)[there]
        frames.append(Frame(2 * time, 1 + np.flatnonzero(there), places, np.zeros((3, 2))))
    return frames


def test_a_plug_falls_everywhere_at_the_same_speed():
    found = axial_flow.measure(falling_frames(lambda r: 0.5 + 0 * r), SCENE, 4, 24)
    for height in axial_flow.HEIGHTS:
        assert found[f"mass_flow_index_{height:g}d"][0] == pytest.approx(1.0)
    assert found["speed_15d_r3.0d"] == pytest.approx([0.5, 0.0], abs=1e-12)
    # 4000 grains over 40 d leave at 0.5 d/tau.
    assert found["outflow"][0] == pytest.approx(50.0, rel=0.1)
    # From 5 d at 0.5 d/tau: 10 tau; snapshots are 2 tau apart.
    assert found["residence_median_5d"][0] == pytest.approx(10.0, abs=1.0)
    # 4000 grains of pi/6 in 40 d of 144 pi.
    assert found["packing_fraction"][0] == pytest.approx(4000 / 6 / 40 / 144, rel=0.1)


def test_profiles_are_those_of_the_flow():
    found = axial_flow.measure(falling_frames(lambda r: 0.5 * np.exp(-r / 6)), SCENE, 0, 24)
    for ring in (1.0, 3.0, 5.0, 7.0, 9.0):
        assert found[f"speed_20d_r{ring:.1f}d"][0] == pytest.approx(0.5 * np.exp(-ring / 6), rel=0.08)
    assert found["mass_flow_index_20d"][0] == pytest.approx(np.exp(-10 / 6), rel=0.1)


def test_rings_end_at_the_wall():
    found = axial_flow.measure(falling_frames(lambda r: 0.5 + 0 * r), SCENE, 4, 24)
    assert [name for name in found if name.startswith("speed_5d")] == [f"speed_5d_r{r}.0d" for r in (1, 3, 5, 7)]
    assert SCENE.radius_at(5.0) == 8.0 and SCENE.radius_at(30.0) == 12.0


def test_times_and_places_count_from_opening_and_outlet():
    """A run that was moved in space and time shows the same, to the last grain."""
    moved = dataclasses.replace(SCENE, opening_time=350.0, axis_x=3.0, axis_y=-5.0, base_z=7.0)
    flow = lambda r: 0.5 * np.exp(-r / 6)
    later = [Frame(frame.timestep + 700, frame.ids, frame.positions + [3.0, -5.0, 7.0], frame.box) for frame in falling_frames(flow)]
    here, there = axial_flow.measure(falling_frames(flow), SCENE, 4, 24), axial_flow.measure(later, moved, 4, 24)
    assert here.keys() == there.keys()
    for name, value in here.items():
        assert there[name] == pytest.approx(value, rel=1e-9, abs=1e-12, nan_ok=True), name
    with pytest.raises(ValueError, match="0 snapshots"):
        axial_flow.measure(later, SCENE, 4, 24)


def test_too_short_an_interval_is_refused():
    with pytest.raises(ValueError, match="2 snapshots between 0 and 2 tau"):
        axial_flow.measure(falling_frames(lambda r: 0.5 + 0 * r), SCENE, 0, 2)


def write_run(folder):
    return write_frames(folder, falling_frames(lambda r: 0.5 + 0 * r, count=400), {**vars(SCENE), "program": "test"})


def test_the_command_compares_and_keeps_statistics(tmp_path):
    run, kept = write_run(tmp_path / "run"), tmp_path / "kept.json"
    said = script("hopper.py", run, "--from", 4, "--to", 24, "-o", kept)
    assert said.returncode == 0 and "quantities" in said.stdout, said.stderr
    said = script("hopper.py", kept, run, run, "--from", 4, "--to", 24, "--plot", tmp_path / "profiles.png")
    assert said.returncode == 0, said.stderr
    assert (tmp_path / "profiles.png").read_bytes().startswith(b"\x89PNG")
    rows = [line.split("|")[1:-1] for line in said.stdout.splitlines()[2:] if line.startswith("|")]
    assert len(rows) == len(json.loads(kept.read_text())["quantities"])
    assert all(row[3].strip() in ("+0.0 %", "-0.0 %", "") for row in rows)
    said = script("hopper.py", kept, run, "--from", 4, "--to", 20)
    assert said.returncode == 1 and "holds the interval 4 to 24 tau, not 4 to 20" in said.stderr


def test_one_run_is_told(tmp_path):
    """Without a file to keep, and with one, whose interval is then the default."""
    run, kept = write_run(tmp_path / "run"), tmp_path / "kept.json"
    told = script("hopper.py", run, "--from", 4, "--to", 20)
    assert told.returncode == 0 and told.stdout.startswith("| 4 to 20 tau | "), told.stderr
    rows = dict(line.split("|")[1:3] for line in told.stdout.splitlines()[2:])
    assert float(rows[" outflow "].split("+-")[0]) == pytest.approx(5, rel=0.3)
    assert not any(words.strip() in ("", "nan") for words in rows.values())
    assert script("hopper.py", run, "--from", 4, "--to", 20, "-o", kept).returncode == 0
    assert script("hopper.py", kept).stdout == told.stdout.replace(str(run), str(kept))
    said = script("hopper.py", kept, run)
    assert said.returncode == 0 and said.stdout.startswith("| 4 to 20 tau |") and "+0.0 %" in said.stdout, said.stderr


def test_a_file_that_keeps_less_is_unknown_there(tmp_path):
    """Statistics of before have fewer quantities; what they lack is told all the same."""
    run, kept = write_run(tmp_path / "run"), tmp_path / "kept.json"
    kept.write_text(json.dumps({"interval": [4, 20], "quantities": {"outflow": [5.0, 0.1]}}))
    said = script("hopper.py", kept, run)
    assert said.returncode == 0 and "| speed_5d_r1.0d | unknown | 0.5" in said.stdout, said.stderr
    kept.write_text(json.dumps({"interval": [4, 20]}))
    said = script("hopper.py", kept, run)
    assert said.returncode == 1 and said.stderr.startswith(f"error: {kept}: no statistics of --output"), said.stderr


@pytest.mark.parametrize("values, said", [
    ({"cylinder_radius": None}, "'cylinder_radius' must be a positive number"),
    ({"orifice_radius": 30.0}, "'orifice_radius' must be below"),
    ({"diameter": -1.0}, "'diameter' must be a positive number"), ({"opening_time": "0"}, "'opening_time' must be a number"),
    ({"base_z": None}, "'base_z' must be a number"), ({"base": 1.0}, "unknown scene key 'base'")])
def test_scenes_that_do_not_fit_are_named(tmp_path, values, said):
    tmp_path.joinpath("scene.json").write_text(json.dumps({**vars(SCENE), **values}))
    with pytest.raises(SceneError, match=f"scene.json: .*{said}"):
        load_axial_scene(tmp_path)


def test_scenes_as_decks_write_them(tmp_path):
    tmp_path.joinpath("scene.json").write_text(json.dumps({**vars(SCENE), "cone_angle": 38.7, "program": "LIGGGHTS", "opening_time": 2}))
    assert load_axial_scene(tmp_path) == dataclasses.replace(SCENE, program="LIGGGHTS", opening_time=2)


def test_other_scenes_are_refused(tmp_path):
    with pytest.raises(SceneError, match="No such file"):
        load_axial_scene(tmp_path)
    tmp_path.joinpath("scene.json").write_text('{"diameter": 1, "half_width_x": 3}')
    with pytest.raises(SceneError, match="no hopper, 'gravity' is missing"):
        load_axial_scene(tmp_path)
    tmp_path.joinpath("scene.json").write_text("{")
    with pytest.raises(SceneError, match="not valid JSON"):
        load_axial_scene(tmp_path)
