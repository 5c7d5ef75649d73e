# SPDX-License-Identifier: GPL-2.0-or-later
"""One command for any scene, and where the others send those that they don't measure."""

import pytest

import test_box
import test_hopper
import test_mixture
import test_passages
from conftest import ANALYSIS, script
from spot_analysis.commands import summary
from synthetic import write_frames

EXAMPLES = ANALYSIS.parent / "examples"


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """A run of each kind."""
    folder = tmp_path_factory.mktemp("runs")
    plug = test_hopper.falling_frames(lambda r: 0.5 + 0 * r, count=400)
    box = test_box.falling_frames(lambda x: 0.5 + 0 * x, times=range(0, 25, 2), count=400)
    return {"hopper": write_frames(folder / "hopper", plug, vars(test_hopper.SCENE)),
            "box": write_frames(folder / "box", box, test_box.SCENE.as_dict()),
            "mixture": write_frames(folder / "mixture", test_mixture.falling_frames(count=400), test_mixture.SCENE.as_dict(), ("radius",))}


@pytest.mark.parametrize("kind, end", [("hopper", 50), ("box", 20), ("mixture", 30)])
def test_each_scene_is_measured_by_its_own_script(runs, kind, end):
    own, any_scene = (script(name, runs[kind]) for name in (f"{kind}.py", "summary.py"))
    assert own.returncode == any_scene.returncode == 0, own.stderr + any_scene.stderr
    assert any_scene.stdout == own.stdout and own.stdout.startswith(f"| 10 to {end} tau |")


def test_a_file_is_compared_and_decides_between_box_and_mixture(runs, tmp_path):
    kept, equal = tmp_path / "kept.json", tmp_path / "equal"
    assert script("summary.py", runs["mixture"], "-o", kept).returncode == 0
    frames = test_mixture.falling_frames(count=400)
    for frame in frames:
        frame.extra["radius"][:] = 1.0
    write_frames(equal, frames, test_mixture.SCENE.as_dict(), ("radius",))
    said = script("summary.py", kept, equal, "--plot", tmp_path / "plot.png")
    assert said.returncode == 0 and "large_share_left |" in said.stdout and (tmp_path / "plot.png").exists(), said.stderr
    assert "still_share" in script("summary.py", equal).stdout


def test_stored_references_are_known():
    """By what they hold: their files do not say of what scene they are."""
    kinds = {"hoppers": "hopper", "benchmark-silo": "hopper", "half-full": "round container", "periodic-slot": "box",
             "two-outlets": "box", "bidisperse": "mixture", "pebble-bed": "turned bed"}
    assert {(path.parent.name, summary.kind_of(str(path)).what) for path in EXAMPLES.glob("*/dem*.json")} == set(kinds.items())


def error_of(name, *arguments):
    said = script(name, *arguments)
    assert said.returncode == 1 and said.stderr.startswith("error: ") and said.stderr.count("\n") == 1, said.stderr
    return said.stderr


def test_scenes_that_differ_are_refused(runs, tmp_path):
    assert f"{runs['hopper']} is a hopper, but {runs['box']} is a box" in error_of("summary.py", runs["hopper"], runs["box"])
    tmp_path.joinpath("scene.json").write_text('{"diameter": 1, "gravity": 1, "timestep": 1, "base_z": 0}')
    assert "tells no walls" in error_of("summary.py", tmp_path)
    assert "no such file or folder" in error_of("summary.py", tmp_path / "none")


def test_who_does_not_measure_a_scene_says_who_does(runs, tmp_path):
    out = ("-o", tmp_path / "statistics.npz")
    for name, more in (("measure.py", out), ("calibrate.py", ()), ("box.py", ()), ("mixture.py", ())):
        assert "is a hopper" in (said := error_of(name, runs["hopper"], *more)) and "analysis/hopper.py measures" in said, name
    assert "analysis/box.py measures" in error_of("hopper.py", runs["box"])
    assert "analysis/box.py takes several" in error_of("mixture.py", runs["box"])
    assert "unequal size are for mixture.py" in error_of("box.py", runs["mixture"])
    assert "box.py takes equal grains" in error_of("mixture.py", write_frames(tmp_path / "bare", test_mixture.falling_frames(count=40),
                                                                              test_mixture.SCENE.as_dict()))


@pytest.mark.parametrize("counted", [True, False])
def test_grains_that_go_round_are_not_for_the_comparison(tmp_path, counted):
    frames = test_passages.round_frames(counted=counted, count=400, times=range(0, 9, 2))
    columns = ("radius", "f_bed[5]") if counted else ("radius",)
    run = write_frames(tmp_path / "run", frames, test_passages.BOX.as_dict(), columns)
    assert "grains have gone round by step" in (said := error_of("measure.py", run, "-o", tmp_path / "x.npz")) and "box.py" in said
    assert script("summary.py", run, "--from", 0, "--to", 8).returncode == 0
