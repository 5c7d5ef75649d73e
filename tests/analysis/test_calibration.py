# SPDX-License-Identifier: GPL-2.0-or-later
"""calibrate.py from dumps to parameters, on points that move in the mean as among spots and are kicked in spheres."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest
from scipy.spatial import cKDTree
from spot_analysis.calibration.estimate import CalibrationError, Estimate
from spot_analysis.calibration.lammps_variables import OFF, RADII, lammps_variables
from spot_analysis.calibration.measurement import measure
from spot_analysis.calibration.parameters import parameters, response_of
from spot_analysis.calibration.refinement import deck_text, refine
from spot_analysis.calibration.response import NAMES, STORED, stored_response
from spot_analysis.calibration.view import CONCEPTS
from spot_analysis.reading.scene import load_scene
from spot_analysis.report import calibration_output
from spot_analysis.statistics.bootstrap import RESAMPLES
from spot_analysis.statistics.measuring import measure_dumps

from conftest import ANALYSIS, script

SCENE = {"program": "synthetic", "diameter": 1.0, "gravity": 1.0, "timestep": 0.01,
         "half_width_x": 25.0, "half_depth_y": 4.0, "orifice_radius": 4.0}
TIMES = np.arange(40, 70.1, 2.0)
FLOW, DENSITY, SPREADING, RADIUS, MISSING = 50.0, 0.8, 0.7, 2.6, 440  # spreading so little that no wall is felt
KICKS, KICK = 3000, 0.0126  # spheres a step; standard deviation, d
KICKED = np.array([[-14, -3, 8], [14, 3, 78]])  # where their centres lie


def flow_of_spots(x, z):
    """u_x and u_z of points where spots spread with SPREADING; together they keep the density."""
    variance = 2 * SPREADING * np.maximum(z, 0) + 6
    bell = FLOW / (DENSITY * 8) * np.exp(-x**2 / (2 * variance)) / np.sqrt(2 * np.pi * variance)
    return -SPREADING * x / variance * bell, -bell


def write_frame(folder, time, ids, points):
    header = (f"ITEM: TIMESTEP\n{round(100 * time)}\nITEM: NUMBER OF ATOMS\n{len(ids)}\n"
              "ITEM: BOX BOUNDS ff ff ff\n-25 25\n-4 4\n-10 120\nITEM: ATOMS id x y z\n")
    with open(folder / f"run.{round(100 * time)}.dump", "w", encoding="ascii") as handle:
        handle.write(header)
        np.savetxt(handle, np.column_stack([ids, points]), fmt="%d %.5f %.5f %.5f")


@pytest.fixture(scope="module")
def dumps(tmp_path_factory):
    """Points at random in the silo, with MISSING more of them in the slab at rest; returns the folder."""
    folder = tmp_path_factory.mktemp("dumps")
    (folder / "scene.json").write_text(json.dumps(SCENE))
    rng = np.random.default_rng(7)
    points = rng.uniform([-25, -4, 0], [25, 4, 85], (int(DENSITY * 400 * 85), 3))
    ids = np.arange(1, len(points) + 1)
    extra = rng.uniform([-25, -4, 50], [25, 4, 70], (MISSING, 3))
    write_frame(folder, 0, np.arange(1, len(points) + MISSING + 1), np.vstack([points, extra]))
    for time in TIMES:
        left = points[:, 2] > -2
        points, ids = points[left], ids[left]
        write_frame(folder, time, ids, points)
        for _ in range(4):
            along, down = flow_of_spots(points[:, 0], points[:, 2])
            points = points + 0.5 * np.column_stack([along, np.zeros(len(points)), down])
        near = cKDTree(points).query_ball_point(rng.uniform(*KICKED, (KICKS, 3)), RADIUS)
        for grains, kick in zip(near, rng.normal(0, KICK, KICKS)):
            points[grains, 0] += kick
    return folder


@pytest.fixture(scope="module")
def result(dumps, tmp_path_factory):
    folder = tmp_path_factory.mktemp("result")
    files = [folder / name for name in ("parameters", "calibration.json", "plots")]
    done = script("calibrate.py", dumps, "--response", "2006", "--buffer", 1, "-o", files[0], "--json", files[1], "--plots", files[2])
    assert done.returncode == 0, done.stderr
    return done, json.loads(files[1].read_text()), files


def near(quantity, truth, slack=0.0):
    assert quantity["error"] > 0
    assert quantity["value"] == pytest.approx(truth, abs=3 * quantity["error"] + slack)


def test_known_parameters(result):
    """Within three standard errors; the drop itself is that of points at random, whose number scatters."""
    content = result[1]
    found, measured = content["parameters"], content["measured"]
    near(measured["outflow"], FLOW, 0.01 * FLOW)  # the points of the first layers, whose number scatters
    near(found["radius"], RADIUS)
    near(found["diffusion"], SPREADING, 0.02)
    slack = np.sqrt(MISSING + 2 * FLOW) / MISSING  # of points that fell out of the slab and into it
    near(found["speed"], FLOW * 20 / MISSING, slack * FLOW * 20 / MISSING)
    assert measured["correlation_amplitude"]["value"] == pytest.approx(1, abs=0.1)


def test_kicks_give_the_influence(result):
    """Var(dx) of a step of 2 tau over twice the drop, in the core; w is that over b_s, and nu_s = F / (w <N>)."""
    content = result[1]
    found, measured = content["parameters"], content["measured"]
    drop = -2 * flow_of_spots(*np.meshgrid(np.linspace(-8, 8, 101), np.linspace(25, 66, 101)))[1].mean()
    sphere = 4 / 3 * np.pi * RADIUS**3
    kicked = KICKS * KICK**2 * sphere / np.prod(KICKED[1] - KICKED[0])
    near(measured["particle_diffusion"], kicked / (2 * drop), 0.05 * kicked)
    assert found["influence"]["value"] == pytest.approx(
        measured["particle_diffusion"]["value"] / found["diffusion"]["value"])
    assert found["injection"]["value"] == pytest.approx(
        measured["outflow"]["value"] / (found["influence"]["value"] * measured["grains_in_spot"]["value"]))
    assert measured["grains_in_spot"]["value"] == pytest.approx(DENSITY * sphere * 0.957, rel=0.03)


def test_table(result):
    done = result[0]
    assert all(line.startswith("warning: ") for line in done.stderr.splitlines()) and "40 to 70 tau, 16 snapshots" in done.stdout
    for symbol in ("R_s", "w", "b_s", "v_s", "nu_s"):
        assert f"\n{symbol} " in done.stdout


def test_parameter_file_speaks_the_decks_language(result):
    lines = [line for line in result[2][0].read_text().splitlines() if not line.startswith("#")]
    sources = ANALYSIS.parent
    deck = "".join((sources / file).read_text() for file in ("examples/silo/in.silo_spot", "lammps-package/glass-beads.lmp"))
    assert [line.split()[1] for line in lines] == ["profile", "radius", "influence", "volume", "diffusion", "dilation", "speed",
                                                   "outflow", *OFF]
    assert lines[0].split("#")[0].split() == ["variable", "profile", "index", "uniform"]
    for line in lines[1:]:
        command, name, style, formula = line.split("#")[0].split()
        assert (command, style) == ("variable", "index")
        assert f"${{{name}}}" in deck or f"$(v_{name}/" in deck
        if name in OFF:
            assert formula == "0"
            continue
        value = eval(formula.strip("$()"), {"v_d": 1.0, "v_tau": 1.0})  # as the deck would, where d = tau = 1
        found = result[1]["measured" if name == "outflow" else "parameters"][name]["value"]
        assert value == pytest.approx(found, rel=1e-5)


def test_parabolic_spots_have_the_volume_of_the_uniform_ones(result):
    """A mean share of 2/5 in a sphere that is 5/2 as large."""
    parameters = {name: Estimate(np.array(number["value"]), np.full(RESAMPLES, number["value"]))
                  for name, number in result[1]["parameters"].items()}

    def deck(profile):
        lines = lammps_variables(parameters, "nothing", (0, 0), profile).splitlines()
        return {line.split()[1]: line.split()[3] for line in lines if line.startswith("variable")}

    uniform, parabolic = deck("uniform"), deck("parabolic")
    radii = [float(one.pop("radius").strip("$()").split("*")[0]) for one in (uniform, parabolic)]
    assert 2 / 5 * radii[1]**3 == pytest.approx(radii[0]**3, rel=1e-4)
    assert uniform.pop("profile") == "uniform" and parabolic.pop("profile") == "parabolic"
    assert uniform == parabolic


def test_plots(result):
    assert sorted(path.name for path in result[2][2].iterdir()) == [
        "correlation.png", "diffusion.png", "flow.png", "profiles.png", "spreading.png"]
    assert all(path.stat().st_size > 5000 for path in result[2][2].iterdir())


def fails(*arguments):
    done = script("calibrate.py", *arguments)
    assert done.returncode == 1 and "Traceback" not in done.stderr
    last = done.stderr.strip().splitlines()[-1]
    assert last.startswith("error: "), done.stderr
    return last


def test_refusals(dumps, tmp_path):
    scene = ("--scene", dumps / "scene.json")
    assert "the first snapshot is at t = 40 tau; v_s needs the packing at rest" in fails(f"{dumps}/run.[4-7]*.dump", *scene)
    text = (dumps / "run.4000.dump").read_text()
    path = tmp_path / "damaged.dump"
    for damaged, message in ((text.replace("id x y z", "id x y vz"), "column 'z' is missing"),
                             (text[:text.rindex(" ")] + " nan\n", "is not finite")):
        path.write_text(damaged)
        assert message in fails(path, *scene)


def test_packing_at_rest_is_refused(dumps, tmp_path):
    text = (dumps / "run.4000.dump").read_text()
    for time in (0, *range(4000, 7000, 200)):
        (tmp_path / f"run.{time}.dump").write_text(text.replace("TIMESTEP\n4000", f"TIMESTEP\n{time}"))
    assert "no steady flow: 0 +- 0 grains a tau leave" in fails(tmp_path, "--scene", dumps / "scene.json")


@pytest.fixture(scope="module")
def measured(dumps):
    run = measure_dumps(str(dumps), load_scene(str(dumps)), concepts=CONCEPTS)
    return measure(run, buffer=1.0)


def test_response_undoes_itself(measured):
    """Parameters put in come back when the response was measured on the same run."""
    put_in = {"radius": 2.3, "influence": 2e-3, "diffusion": 1.1, "speed": 3.0}
    slopes = stored_response("windowed")
    found = parameters(measured, response_of(measured, put_in, slopes))
    for name, value in put_in.items():
        assert found[name].value == pytest.approx(value, rel=1e-6), name


def test_influence_that_relaxation_hides_is_refused(measured):
    response = {**stored_response("unrelaxed"), "particle_diffusion": measured.diffusion.length}
    with pytest.raises(CalibrationError, match="w is not determined: .* of b_p = .* relaxation alone makes"):
        parameters(measured, response)


def test_stored_responses_name_every_parameter():
    for driver in STORED:
        response = stored_response(driver)
        assert set(response) == set(NAMES)
        assert all(0 <= value.value < 1.5 for value in response.values())


def fake_lmp(folder, body):
    path = folder / "lmp.py"
    path.write_text(f"import shutil, sys\nout = sys.argv[sys.argv.index('out') + 1]\n{body}\n")
    return f"{sys.executable} {path}"


def test_refinement_ends_where_the_run_shows_the_target(measured, dumps, tmp_path):
    """A model that always shows the target: whatever was put in stays."""
    nothing = stored_response("2006")
    start = parameters(measured, nothing)
    deck = ANALYSIS.parent / "examples" / "silo" / "in.silo_spot"
    lmp = fake_lmp(tmp_path, f"shutil.copytree({str(dumps)!r}, out)")
    said = []
    found, response = refine(measured, nothing, 1, str(deck), lmp, 90, "dz 0.0006", print, said.append)
    for name, value in start.items():
        assert found[name].value == pytest.approx(value.value, rel=1e-5), name
    assert response["radius"].value == pytest.approx(0, abs=1e-5)
    assert len(said) == 1 and "round 1: a run with radius 2." in said[0]


def test_failing_runs_are_refused(measured, tmp_path):
    nothing = stored_response("2006")
    deck = str(ANALYSIS.parent / "examples" / "silo" / "in.silo_spot")

    def refined(lmp, deck=deck):
        return refine(measured, nothing, 1, deck, lmp, 90)

    with pytest.raises(CalibrationError, match="lmp failed on .*: ERROR: no fix spot"):
        refined(fake_lmp(tmp_path, "print('LAMMPS')\nprint('ERROR: no fix spot')\nsys.exit(1)"))
    with pytest.raises(CalibrationError, match="cannot run absent-lmp: No such file"):
        refined("absent-lmp")
    (tmp_path / "in.other").write_text("units si\n")
    with pytest.raises(CalibrationError, match="0 commands 'fix ID group spot'"):
        refined("lmp", str(tmp_path / "in.other"))


def test_deck_for_a_refinement():
    deck = ANALYSIS.parent / "examples" / "silo" / "in.silo_spot"
    lines = deck_text(str(deck), "/tmp/p", 90, "dz 0.0006").splitlines()
    place = next(number for number, line in enumerate(lines) if "glass-beads.lmp" in line)
    assert lines[place - 3:place] == ["include /tmp/p", "variable time delete", "variable time equal 90*v_tau"]
    fix = next(line for line in lines if line.startswith("fix "))
    assert fix.endswith(" dz 0.0006") and "&" not in fix


def test_unknown_numbers_are_null():
    assert calibration_output.described(Estimate(np.array(np.nan), np.full(10, np.nan)), "d")["value"] is None


@pytest.mark.skipif("SPOT_PRINT_PROFILES" not in os.environ, reason="ctest names the program of spot-core")
def test_profiles_have_the_radii_of_the_library():
    lines = subprocess.run([os.environ["SPOT_PRINT_PROFILES"]], capture_output=True, text=True, check=True).stdout
    library = {name: float(radius) for name, _, radius in (line.split() for line in lines.splitlines())}
    assert RADII == pytest.approx(library, rel=1e-12)
