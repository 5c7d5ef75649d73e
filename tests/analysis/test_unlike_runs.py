# SPDX-License-Identifier: GPL-2.0-or-later
"""Runs unlike the silo of 2006: without grains for some time, elsewhere in space and time, at another cadence, too low; and
dumps that are none. Whatever cannot be measured is absent, and said; what would be measured wrongly is refused."""

import gzip
import json
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.stats import qmc
from spot_analysis.base.errors import AnalysisError
from spot_analysis.reading.dump import read_frames
from spot_analysis.reading.scene import load_scene
from spot_analysis.report import comparison, curves, figures
from spot_analysis.statistics import run_statistics
from spot_analysis.statistics.interval import choose_interval
from spot_analysis.statistics.interval_view import IntervalView
from spot_analysis.statistics.measuring import measure_dumps

from conftest import script
from synthetic import SCENE, frame_text, write_text

SILO = {**SCENE, "orifice_radius": 4.0}
SI = {"program": "synthetic", "diameter": 0.003, "gravity": 9.81, "timestep": 1e-4 * (0.003 / 9.81)**0.5, "half_width_x": 0.03, "half_depth_y": 0.012,
      "orifice_radius": 0.012}
TIMES = np.arange(0, 22, 2.0)


def drain(times=TIMES, top=76.0, bottom=0.5, speed=0.5):
    """(time, ids, positions) of evenly strewn points that fall as through an orifice, faster on the axis; those below -2 d are
    gone."""
    rng = np.random.default_rng(1)
    start = qmc.scale(qmc.Halton(3, seed=1).random(int(40 * (top - bottom))), [-9.5, -3.5, bottom], [9.5, 3.5, top])
    start = start[~((np.hypot(start[:, 0], start[:, 1]) > 3.9) & (start[:, 2] < 1))]
    for time in times:
        positions = start - np.outer(speed * time * np.exp(-start[:, 0]**2 / 40), [0, 0, 1])
        positions += 0.05 * np.sqrt(max(time, 0)) * rng.normal(size=start.shape) * [1, 0, 0]
        kept = (positions[:, 2] > 0.01) | (np.hypot(positions[:, 0], positions[:, 1]) < 3.9) & (positions[:, 2] > -2)
        positions[:, 0] = positions[:, 0].clip(-9.9, 9.9)
        yield time, np.flatnonzero(kept) + 1, positions[kept]


def write_run(folder, frames, scene=SILO, **keys):
    """Dumps of (time, ids, positions) in tau and d, and their scene.json; keys : of the scene, more or others."""
    folder.mkdir()
    scene = {**scene, **keys}
    (folder / "scene.json").write_text(json.dumps(scene))
    tau = (scene["diameter"] / scene["gravity"])**0.5
    origin = [scene.get(key, 0) for key in ("axis_x", "axis_y", "base_z")]
    for time, ids, positions in frames:
        step = round((time * tau + scene.get("opening_time", 0)) / scene["timestep"])
        write_text(folder / f"drain.{step}.dump", frame_text(step, ids, positions * scene["diameter"] + origin))
    return str(folder)


def measured(source):
    """RunStatistics and the warnings."""
    warnings = []
    return measure_dumps(source, load_scene(source), warn=warnings.append), warnings


@pytest.fixture(scope="module")
def full(tmp_path_factory):
    """The statistics of a run as most of those here are in the beginning, and their file."""
    folder = tmp_path_factory.mktemp("runs")
    run, warnings = measured(write_run(folder / "full", drain()))
    assert not warnings
    run.save(folder / "full.npz")
    return SimpleNamespace(run=run, path=folder / "full.npz")


# ---- snapshots without grains

NONE = np.empty(0, dtype=np.int64), np.empty((0, 3))


def emptied(frames, which):
    return [(time, *(NONE if which(index) else (ids, positions))) for index, (time, ids, positions) in enumerate(frames)]


EMPTY = {"later half": lambda index: index >= len(TIMES) // 2, "first": lambda index: index == 0, "all": lambda index: True,
         "one in between": lambda index: index == 4, "second and last": lambda index: index in (1, len(TIMES) - 1)}


@pytest.mark.parametrize("case", EMPTY)
@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_snapshots_without_grains_are_measured(full, tmp_path, case):
    source = write_run(tmp_path / "empty", emptied(drain(), EMPTY[case]))
    run, _ = measured(source)
    np.testing.assert_array_equal(run.grains == 0, [EMPTY[case](index) for index in range(len(TIMES))])
    assert np.all(run.above[run.grains == 0] == 0) and np.all(run.outside == 0)
    run.save(tmp_path / "empty.npz")
    run, dem = run_statistics.load(tmp_path / "empty.npz"), full.run
    # as in the full run wherever a snapshot and the one before it have grains
    same = run.grains > 0
    np.testing.assert_array_equal(run.above[same], dem.above[same][:, :run.above.shape[1]])
    views = {name: IntervalView(one, np.arange(len(TIMES)), choose_interval(TIMES))
             for name, one in (("DEM", dem), ("spot", run))}
    rows = {row.name: row for row in comparison.compare(*views.values())}
    for row in rows.values():
        assert row.spot is None or np.isfinite(row.spot), row.name
        assert (row.left_out is not None) == (row.spot is None or (row.dem is None and row.difference is None and row.name in
                                              comparison.quantities(views["DEM"]))), row.name
    curves.as_lists(views)
    if case in ("later half", "all"):
        assert rows["surface_height_axis"].spot is None
        assert figures.draw_pictures(tmp_path, views, lambda text, share: None)
    if case == "all":
        assert rows["packing_fraction"].left_out == rows["largest_overlap"].left_out == "spot: there are no grains"
        assert rows["crystal_share"].left_out == "spot: no snapshot fills z = 15 d to 50 d"
        assert rows["outflow"].spot == 0
    if case in ("later half", "one in between"):
        assert rows["packing_fraction"].spot == pytest.approx(rows["packing_fraction"].dem, rel=0.02)


def test_scripts_take_snapshots_without_grains(full, tmp_path):
    source = write_run(tmp_path / "empty", emptied(drain(), EMPTY["later half"]))
    compared = script("compare.py", full.path, source, "-o", tmp_path / "out")
    assert compared.returncode == 0, compared.stderr
    found = json.loads((tmp_path / "out" / "comparison.json").read_text())["quantities"]
    assert found["surface_angle_last"]["spot"] is None and found["grains_left"]["spot"] == 0
    beside = script("side_by_side.py", full.path, f"empty={source}")
    assert "empty: arrival_30d, early" in "\n".join(warnings_of(beside))
    for refused, cause in ((script("calibrate.py", source, "--from", 0), "error: "),
                           (script("cell_imprint.py", source, "--from", TIMES[6], "--to", TIMES[-1]), "error: no grains in the bulk")):
        assert refused.returncode == 1 and "Traceback" not in refused.stderr
        assert refused.stderr.splitlines()[-1].startswith(cause)


def test_baseline_that_drains_to_the_last_grain(tmp_path):
    frames = [(0.0, np.arange(1, 101), np.random.default_rng(1).uniform([-2, -2, 16], [2, 2, 26], (100, 3)))]
    packing = write_run(tmp_path / "packing", frames)
    made = script("baseline.py", "kinematic", packing, "-o", tmp_path / "out", "--time", 20, "--outflow", 50)
    assert made.returncode == 0, made.stderr
    assert [len(frame.ids) for frame in read_frames(str(tmp_path / "out"))][-1] == 0
    measured(str(tmp_path / "out"))
    none = write_run(tmp_path / "none", [(0.0, *NONE)])
    assert "no grain in" in script("baseline.py", "kinematic", none, "-o", tmp_path / "out2").stderr


# ---- other scenes

SHIFTS = {"base": {"base_z": 5.0}, "axis": {"axis_x": 12.5, "axis_y": -3.25}, "time": {"opening_time": 100.0},
          "all": {"axis_x": -100.0, "axis_y": 0.5, "base_z": -40.0, "opening_time": 30.0}}
PARTS = ("grains", "above", "outside", "region_grains", "contacts", "badness", "rdf_counts", "profile_counts", "profile_sums",
         "profile_start", "picture_times", "picture_x", "picture_z", "picture_layer", "largest_wall_overlap")


def assert_same(one, other):
    np.testing.assert_allclose(one.times, other.times, atol=1e-6)
    for name in PARTS:
        np.testing.assert_allclose(getattr(one, name), getattr(other, name), rtol=1e-6, atol=1e-6, err_msg=name)
    for concept, part in one.measured.items():
        for name, array in vars(part).items():
            np.testing.assert_allclose(array, getattr(other.measured[concept], name), rtol=1e-5, atol=1e-5, err_msg=f"{concept}.{name}")


@pytest.mark.parametrize("case, scene", [*((case, SILO) for case in SHIFTS), ("all", SI)])
def test_scene_that_is_shifted_gives_the_same_statistics(full, tmp_path, case, scene):
    tau = (scene["diameter"] / scene["gravity"])**0.5
    scale = {"opening_time": scene["timestep"] * round(tau / scene["timestep"])}
    keys = {key: value * scale.get(key, scene["diameter"]) for key, value in SHIFTS[case].items()}
    shifted, warnings = measured(write_run(tmp_path / "shifted", drain(), scene, **keys))
    assert_same(full.run, shifted)
    assert not warnings


def test_snapshots_before_the_opening_are_left_out(full, tmp_path):
    frames = [(-4.0, *NONE), *drain([-2.0]), *drain()]
    run, warnings = measured(write_run(tmp_path / "poured", frames, opening_time=50.0))
    assert_same(run, full.run)
    assert len(warnings) == 1 and "2 snapshots from before the orifice opens, at 50 (opening_time), are left out" in warnings[0]
    with pytest.raises(AnalysisError, match="all 1 snapshots are from before the orifice opens, at 50"):
        measured(write_run(tmp_path / "early", frames[:1], opening_time=50.0))


def test_cells_and_baselines_follow_the_scene(tmp_path):
    """The same imprint, and dumps of a baseline that begin at the origin."""
    keys = {"axis_x": 40.0, "axis_y": 2.0, "base_z": 7.0}
    sources = [write_run(tmp_path / "plain", drain(TIMES[:4])), write_run(tmp_path / "shifted", drain(TIMES[:4]), **keys)]
    one, other = (script("cell_imprint.py", source, "--from", 0).stdout for source in sources)
    assert one == other and one.count("\n") == 8
    frames = []
    for number, source in enumerate(sources):
        made = script("baseline.py", "kinematic", f"{source}", "-o", tmp_path / f"out{number}", "--time", 4)
        assert made.returncode == 0, made.stderr
        frames.append(list(read_frames(str(tmp_path / f"out{number}"))))
    for plain, shifted in zip(*frames):
        np.testing.assert_array_equal(plain.ids, shifted.ids)
        np.testing.assert_allclose(plain.positions, shifted.positions, atol=1e-6)


def test_origin_on_the_command_line(full, tmp_path):
    source = write_run(tmp_path / "shifted", drain(), axis_x=-12.5, base_z=5.0)
    (tmp_path / "shifted" / "scene.json").write_text(json.dumps(SILO))
    done = script("measure.py", source, "-o", tmp_path / "a.npz", "--axis-x", -12.5, "--base-z", 5)
    assert done.returncode == 0, done.stderr
    run = run_statistics.load(tmp_path / "a.npz")
    np.testing.assert_array_equal(run.above, full.run.above)
    assert (run.scene.axis_x, run.scene.base_z) == (-12.5, 5)


UNLIKE = {
    "a key that nobody knows": ('"shape": "cylinder"', "unknown scene key 'shape'; allowed are diameter, gravity, timestep, "
                                "half_width_x, half_depth_y, orifice_radius, opening_time, axis_x, axis_y, base_z, program, grains"),
    "a misspelt key": ('"base": 5', "unknown scene key 'base'; allowed"),
    "a key twice": ('"gravity": 2', "key 'gravity' stands there twice"),
    "a vector": ('"axis_x": [0, 1]', "'axis_x' must be a number, not [0, 1]"),
}


@pytest.mark.parametrize("case", UNLIKE)
def test_scene_that_says_more_than_is_known(full, tmp_path, case):
    text, message = UNLIKE[case]
    source = write_run(tmp_path / "unlike", drain(TIMES[:1]))
    path = tmp_path / "unlike" / "scene.json"
    path.write_text(path.read_text()[:-1] + f", {text}}}")
    for done in (script("measure.py", source, "-o", tmp_path / "a.npz"), script("compare.py", full.path, source, "-o", tmp_path / "out")):
        assert done.returncode == 1 and done.stdout == ""
        assert done.stderr.splitlines()[-1].startswith("error: ") and f"{path}: " in done.stderr and message in done.stderr


def test_statistics_of_a_scene_that_says_more_than_is_known(full, tmp_path):
    with np.load(full.path) as stored:
        arrays = dict(stored)
    header = json.loads(str(arrays.pop("header")))
    header["scene"]["shape"] = "cylinder"
    np.savez(tmp_path / "a.npz", header=json.dumps(header), **arrays)
    with pytest.raises(AnalysisError, match="a.npz: unknown scene key 'shape'"):
        run_statistics.load(tmp_path / "a.npz")


# ---- what is said

def warnings_of(done):
    assert done.returncode == 0, done.stderr
    return [line for line in done.stderr.splitlines() if line.startswith("warning: ")]


MISPLACED = {  # keys of the scene that the dumps were made with and that scene.json lacks -> how many are outside
    "two grains": ({}, 2), "axis": ({"axis_x": 10.0}, 300), "too narrow": ({}, 300)}


@pytest.mark.parametrize("case", MISPLACED)
def test_grains_outside_are_said(tmp_path, case):
    keys, least = MISPLACED[case]
    (time, ids, positions), later = drain([0.0, 2.0])
    if case == "two grains":
        positions[:2] = [[10.2, 0, 20], [8, 0, -0.5]]
    source = write_run(tmp_path / "run", [(time, ids, positions), later], **keys)
    (tmp_path / "run" / "scene.json").write_text(json.dumps({**SILO, **({"half_depth_y": 3.0} if case == "too narrow" else {})}))
    done = script("measure.py", source, "-o", tmp_path / "a.npz")
    run = run_statistics.load(tmp_path / "a.npz")
    outside = run.outside.max()
    assert outside == least if case == "two grains" else outside > least
    assert f"grains outside walls and base: at most {outside}\n" in done.stdout
    assert sum(f"{outside} of {run.grains[run.outside.argmax()]} grains are outside the walls and the base" in line
               for line in warnings_of(done)) == 1


def test_no_grain_outside_is_said(tmp_path):
    done = script("measure.py", write_run(tmp_path / "run", drain([0.0, 2.0])), "-o", tmp_path / "a.npz")
    assert "grains outside walls and base: at most 0\n" in done.stdout
    assert not any("outside" in line for line in warnings_of(done))


def left_out(done):
    """The one warning that names what was left out: name -> reason."""
    lines = [line for line in warnings_of(done) if "left out: " in line]
    assert len(lines) == 1
    groups = lines[0].split("left out: ")[1].rstrip(")").split("); ")
    return {name: group.split(" (", 1)[1] for group in groups for name in group.split(" (", 1)[0].split(", ")}


def test_snapshots_2_5_tau_apart(full, tmp_path):
    """Velocities need 2 tau; so does the Fano factor. All else is measured."""
    times = np.arange(0, 12.6, 2.5)
    source = write_run(tmp_path / "run", drain(times))
    reasons = left_out(script("measure.py", source, "-o", tmp_path / "a.npz"))
    cause = "no two snapshots are 2 tau apart but 2.5 tau and more"
    apart = {name for name, reason in reasons.items() if reason == cause}
    assert apart == {"outflow_fano", "profile_variance_10d", "profile_variance_30d", "profile_variance_50d", "profile_variance_slope",
                     *(f"gaussian_variance_{z}0d" for z in range(1, 7)), "variance_slope", "variance_intercept", "correlation_length",
                     "correlation_amplitude", "frame_velocity_rms", "particle_diffusion", "speed_wall_over_middle",
                     *(f"stagnant_boundary_{z}d" for z in (5, 10, 20, 30))}
    assert set(reasons) - apart <= {"arrival_30d", "arrival_60d", "arrival_90d", "rdf_first_minimum", "packing_axis_less_shoulder",
                                    *(f"residence_{part}_{z}d" for part in ("p16", "median", "p84") for z in (10, 20))}
    compared = left_out(script("compare.py", full.path, source, "-o", tmp_path / "out"))
    assert {name for name, reason in compared.items() if cause[:34] in reason} >= apart


def test_low_packing(tmp_path):
    source = write_run(tmp_path / "run", drain(top=22.0))
    reasons = left_out(script("measure.py", source, "-o", tmp_path / "a.npz"))
    assert reasons["packing_fraction"] == reasons["crystal_share"] == "no snapshot fills z = 15 d to 50 d"
    assert reasons["flux_30d"] == reasons["slab_count"] == "no grain is higher than z = 22 d"
    assert reasons["particle_diffusion"] == "no snapshot fills z = 25 d to 70 d"
    assert "outflow" not in reasons and "flux_10d" not in reasons


def test_single_snapshot(tmp_path):
    reasons = left_out(script("measure.py", write_run(tmp_path / "run", drain([0.0])), "-o", tmp_path / "a.npz"))
    assert reasons["profile_variance_10d"] == "no two snapshots are 2 tau apart"
    assert "packing_fraction" not in reasons


def test_base_elsewhere(tmp_path):
    """A base at z = 5 d that the scene does not know of."""
    source = write_run(tmp_path / "run", drain(), base_z=5.0)
    (tmp_path / "run" / "scene.json").write_text(json.dumps(SILO))
    lines = warnings_of(script("measure.py", source, "-o", tmp_path / "a.npz"))
    assert sum("lowest grain of the first snapshot lies 5." in line and "'base_z'" in line for line in lines) == 1


# ---- dumps that are cut, as on a full disk

CUTS = {
    "empty": ("drain.200.dump", lambda data: b"", "the file is empty"),
    "rows": ("drain.200.dump", lambda data: data[:len(data) * 2 // 3], "the file ends inside 'ITEM: ATOMS'"),
    "header": ("drain.200.dump", lambda data: data[:40], "the file ends inside"),
    "last of the rows": ("drain.2000.dump", lambda data: data[:-1], "the file ends inside 'ITEM: ATOMS'"),
    "gzip": ("drain.2000.dump", lambda data: gzip.compress(data)[:-20], "the compressed file ends"),
}


@pytest.mark.parametrize("case", CUTS)
def test_cut_dumps_are_an_error_of_each_script(full, tmp_path, case):
    name, cut, message = CUTS[case]
    source = write_run(tmp_path / "run", drain())
    path = tmp_path / "run" / name
    path.write_bytes(cut(path.read_bytes()))
    commands = [("measure.py", source, "-o", tmp_path / "a.npz"), ("compare.py", full.path, source, "-o", tmp_path / "out"),
                ("calibrate.py", source), ("cell_imprint.py", source)]
    for command in commands if case == "rows" else commands[:1]:
        done = script(*command)
        last = done.stderr.splitlines()[-1]
        assert done.returncode == 1 and last.startswith(f"error: {path}") and message in last, done.stderr
    assert not (tmp_path / "a.npz").exists() and not (tmp_path / "out").exists()


def test_cut_statistics(full, tmp_path):
    data = full.path.read_bytes()
    damaged = bytearray(data)
    damaged[len(data) // 2] ^= 0xff
    for part in (b"", data[:len(data) // 2], bytes(damaged)):
        (tmp_path / "a.npz").write_bytes(part)
        with pytest.raises(AnalysisError, match="a.npz: not a statistics file of measure.py, or a damaged one"):
            run_statistics.load(tmp_path / "a.npz")
