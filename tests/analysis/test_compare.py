# SPDX-License-Identifier: GPL-2.0-or-later
"""measure.py and compare.py from dumps to report, on a plug that falls at a known speed."""

import json
import math
import os
import subprocess
import sys

import numpy as np
import pytest
from spot_analysis.report.figures import SECTIONS as FIGURES

from conftest import ANALYSIS
from synthetic import LAYER, SCENE, frame_text, write_plug_flow, write_text

TIMES = range(0, 26, 2)
SI_SCENE = {"program": "synthetic", "diameter": 0.003, "gravity": 9.81, "timestep": 1.75e-6,
            "half_width_x": 0.03, "half_depth_y": 0.012, "orifice_radius": 0.036}
NUMBERS = {"dem", "dem_error", "spot", "spot_error", "difference", "difference_error"}


def script(name, *arguments, python=(sys.executable,), **environment):
    return subprocess.run([*python, str(ANALYSIS / name), *map(str, arguments)], capture_output=True, text=True,
                          env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1", **environment})


def succeed(name, *arguments):
    result = script(name, *arguments)
    assert result.returncode == 0, result.stderr
    return result


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """DEM in reduced units as statistics; spot in SI units, many frames in one file, at half the speed."""
    folder = tmp_path_factory.mktemp("runs")
    dem = write_plug_flow(folder / "dem", 1.0, TIMES)
    stored = str(folder / "dem.npz")
    succeed("measure.py", dem, "-o", stored)
    spot = write_plug_flow(folder / "spot", 0.5, TIMES, SI_SCENE, files=False)
    return {"dumps": dem, "dem": stored, "spot": spot, "folder": folder}


@pytest.fixture(scope="module")
def report(runs):
    output = runs["folder"] / "report"
    result = succeed("compare.py", runs["dem"], runs["spot"], "-o", output)
    return output, result.stdout, json.loads((output / "comparison.json").read_text())


def test_schema(report):
    content = report[2]
    for name, quantity in content["quantities"].items():
        assert set(quantity) == NUMBERS | {"unit", "bound", "met", "paper"}, name
        assert isinstance(quantity["unit"], str)
        assert all(quantity[key] is None or isinstance(quantity[key], (int, float)) for key in NUMBERS)
        assert quantity["met"] in (None, True, False) and (quantity["bound"] is not None or quantity["met"] is None)
        assert quantity["paper"] is None or set(quantity["paper"]) == {"dem", "spot", "source"}
    expected = {"outflow", "flux_2d", "flux_10d", "flux_30d", "flux_60d", "slab_count", "density_drop", "badness",
                "largest_overlap", "packing_fraction", "contacts_per_grain", "rdf_l2", "profile_variance_10d",
                "profile_variance_30d", "profile_variance_50d", "grains_outside", "flux_10d_over_outflow",
                "outflow_fano", "arrival_30d", "arrival_60d", "arrival_90d", "variance_slope", "variance_intercept",
                "correlation_length", "correlation_rms", "particle_diffusion", "badness_ratio", "rdf_l2_ratio", "g3_l2_ratio",
                "crystal_share", "voronoi_fraction", "speed_wall_over_middle", "surface_angle", "stagnant_boundary_10d",
                "residence_median_10d", "unlike_neighbours", "drained_height_mean", "frame_velocity_rms",
                "frame_correlation_rms", "packing_axis_less_shoulder", "packing_profile_rms"}
    assert expected <= set(content["quantities"])
    assert content["interval"] == {"from": 0, "to": 24, "unit": "tau", "kind": "everything", "snapshots": 13,
                                   "common_from": 0, "common_to": 24}


def test_known_numbers(report):
    """160 grains a layer; the DEM plug falls a layer in 2 tau, the spot plug half a layer."""
    quantities = report[2]["quantities"]

    def check(name, dem, spot, **tolerance):
        assert quantities[name]["dem"] == pytest.approx(dem, **tolerance), name
        assert quantities[name]["spot"] == pytest.approx(spot, **tolerance), name
        assert quantities[name]["difference"] == pytest.approx(
            quantities[name]["spot"] - quantities[name]["dem"]), name

    check("grains_initial", 12800, 12800)
    check("grains_drained", 12 * 160, 6 * 160)
    for name in ("outflow", "flux_2d", "flux_10d", "flux_30d"):
        check(name, 80, 40, rel=1e-5)  # the SI deck rounds its timestep
    check("flux_10d_over_outflow", 1, 1)
    fraction = 160 / (20 * 8) / LAYER * math.pi / 6  # the region holds 30 or 31 layers
    check("packing_fraction", fraction, fraction, rel=0.03)
    check("contacts_per_grain", 2, 2)
    check("badness", 2e-4, 2e-4, rel=1e-4)
    check("largest_overlap", 0.01, 0.01, rel=1e-5)
    check("largest_wall_overlap", 0.0095, 0.0095, rel=1e-5)
    check("grains_outside", 0, 0)
    check("outflow_fano", 0, 80**2 * 12 / 11 / 80, abs=1e-9)  # half a layer in 2 tau: none and 160 by turns
    check("drained_height_mean", 6 * LAYER, 3 * LAYER, abs=0.8)
    check("surface_angle", 0, 0, abs=1e-9)
    check("speed_wall_over_middle", 1, 1)
    assert quantities["badness_ratio"]["spot"] == pytest.approx(1, rel=1e-4)
    for height in (10, 30, 50):
        check(f"profile_variance_{height}d", (18**2 - 1) / 12, (18**2 - 1) / 12, rel=1e-5)
    assert quantities["rdf_l2"]["spot"] == pytest.approx(0, abs=0.2)


def test_steady_flow_has_no_scatter(report):
    """24 tau make four blocks, so errors are given: those of a count that never changes are 0."""
    assert report[2]["quantities"]["outflow"]["dem_error"] == pytest.approx(0, abs=1e-9)


def test_table_names_interval_and_every_quantity(report):
    _, stdout, content = report
    assert "interval compared: 0 to 24 tau (everything" in stdout
    assert all(f"\n{name} " in stdout for name in content["quantities"])
    judged = [quantity["met"] for quantity in content["quantities"].values() if quantity["met"] is not None]
    assert len(judged) == 2  # the others are for steady flow, which starts later
    assert f"\nbounds met: {sum(judged)} of 2; " in stdout
    assert "; 34 not judged: most need steady flow, from 40 tau on" in stdout


def test_curves(report):
    curves = report[2]["curves"]
    assert {"velocity_correlation", "particle_variance", "profile_variance", "rdf", "g3", "velocity_30d", "residence_10d",
            "packing_across", "surface", "stagnant_boundary", "drained_by_height"} <= set(curves)
    for name, curve in curves.items():
        for run in {"dem", "spot", "initial"} & set(curve):
            assert len(curve[run]["x"]) == len(curve[run]["y"]) > 0, name
    assert max(curves["velocity_30d"]["dem"]["y"][1:-1]) == pytest.approx(LAYER / 2, rel=1e-5)


def test_report_is_self_contained(report):
    page = (report[0] / "report.html").read_text()
    names = [name for section in FIGURES.values() for name in section]
    assert page.count("data:image/png;base64,") == len(names) == 19
    assert "http" not in page and 'src="data' in page
    assert page.index("The figures of 2006") < page.index("<table>") < page.index("The figures of 2010")
    for name in names:
        assert (report[0] / f"{name}.png").stat().st_size > 5000


def test_statistics_that_lack_a_part(runs, tmp_path):
    with np.load(runs["dem"]) as stored:
        kept = {name: stored[name] for name in stored.files if not name.startswith("voronoi.")}
    np.savez(tmp_path / "part.npz", **kept)
    assert "part.npz: the statistics lack voronoi" in fails("compare.py", runs["dem"], tmp_path / "part.npz", "-o", tmp_path)


def test_stored_statistics_equal_the_dumps(runs):
    output = runs["folder"] / "self"
    succeed("compare.py", runs["dem"], runs["dumps"], "-o", output)
    for name, quantity in json.loads((output / "comparison.json").read_text())["quantities"].items():
        if quantity["difference"] is not None:
            assert quantity["difference"] == pytest.approx(0, abs=1e-5), name


def test_chosen_interval(runs):
    output = runs["folder"] / "chosen"
    succeed("compare.py", runs["dem"], runs["dem"], "-o", output, "--from", 4, "--to", 12)
    content = json.loads((output / "comparison.json").read_text())
    assert (content["interval"]["from"], content["interval"]["to"], content["interval"]["kind"]) == (4, 12, "chosen")
    assert content["quantities"]["outflow"]["dem"] == pytest.approx(80)
    assert content["quantities"]["outflow"]["dem_error"] is None
    assert content["quantities"]["grains_drained"]["dem"] == 12 * 160


def fails(name, *arguments, **options):
    result = script(name, *arguments, **options)
    assert result.returncode != 0
    assert "Traceback" not in result.stderr
    *progress, last = result.stderr.strip().splitlines()
    assert last.startswith("error: ") and "error" not in "".join(progress), result.stderr
    return last


def test_command_line_errors(runs, tmp_path):
    dem, spot, out = runs["dem"], runs["spot"], ("-o", tmp_path / "out")
    assert "absent: no such file" in fails("compare.py", dem, "absent", *out, "--spot-scene", f"{spot}/scene.json")
    assert "'diameter' is missing" in fails("compare.py", dem, tmp_path, *out)
    assert "absent.json: No such file" in fails("compare.py", dem, spot, *out, "--spot-scene", "absent.json")
    assert "fewer than two common" in fails("compare.py", dem, dem, *out, "--from", 100)
    dumps = f"{runs['dumps']}/run.?00.dump.gz"
    assert "different containers: half_width" in fails("compare.py", dem, dumps, *out, "--spot-half-width-x", 12)
    assert "fewer than two times are common" in fails("compare.py", dem, dumps, *out, "--spot-timestep", 0.013)
    assert "does not fit the dump" in fails("measure.py", spot, "-o", tmp_path / "a.npz", "--diameter", 1)
    broken = tmp_path / "broken.npz"
    broken.write_text("no statistics")
    assert "broken.npz: not a statistics file" in fails("compare.py", broken, dem, *out)
    np.savez(broken, header=json.dumps({"format": "another"}))
    assert "another format" in fails("compare.py", broken, dem, *out)
    assert "absent/a.npz: No such file" in fails("measure.py", dumps, "-o", "absent/a.npz")


def test_dump_errors_reach_the_command_line(tmp_path):
    (tmp_path / "scene.json").write_text(json.dumps(SCENE))
    path = write_text(tmp_path / "a.dump", frame_text(0, [1, 2], [[0, 0, 1], [0, math.nan, 2]]))
    assert "position of grain 2 is not finite" in fails("measure.py", path, "-o", tmp_path / "a.npz")
    write_text(tmp_path / "a.dump", "")
    assert "a.dump: the file is empty" in fails("measure.py", tmp_path, "-o", tmp_path / "a.npz")
    write_text(tmp_path / "a.dump", frame_text(0, [1], [[0, 0, 1]])[:-3])
    assert "the file ends inside" in fails("measure.py", tmp_path, "-o", tmp_path / "a.npz")
    text = frame_text(0, [1, 2], [[0, 0, 1], [0, 0, 3]], "id x y z radius", extra=[("radius", [0.5, 0.6])])
    write_text(tmp_path / "a.dump", text)
    assert "grain 2 has radius 0.6" in fails("measure.py", tmp_path, "-o", tmp_path / "a.npz")


def test_interpreter_without_numpy():
    """-S leaves the folder of distribution packages out."""
    message = fails("compare.py", "a", "b", python=(sys.executable, "-S"), PYTHONPATH="")
    assert "/usr/bin/python3" in message and "python3-numpy" in message


def test_few_grains_leave_unknown_values_null(tmp_path):
    """A run with nothing in the region, the slab or the profiles."""
    folder = tmp_path / "few"
    folder.mkdir()
    (folder / "scene.json").write_text(json.dumps(SCENE))
    ids = np.arange(1, 41)
    lattice = np.mgrid[-2:3, -1:3:2, 0:4].reshape(3, -1).T * 1.5 + [0, 0, 0.5]
    write_text(folder / "a.dump", "".join(frame_text(step, ids, lattice) for step in (0, 200, 400)))
    succeed("compare.py", folder, folder, "-o", tmp_path / "out")
    quantities = json.loads((tmp_path / "out" / "comparison.json").read_text())["quantities"]
    for name in ("slab_count", "density_drop", "packing_fraction", "badness", "rdf_l2", "profile_variance_30d",
                 "flux_60d"):
        assert quantities[name]["dem"] is None and quantities[name]["difference"] is None, name
    assert quantities["outflow"]["dem"] == 0
