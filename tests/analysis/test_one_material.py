# SPDX-License-Identifier: GPL-2.0-or-later
"""one_material.py on plugs that fall: its table, runs that are kept, and which rows the references carry."""

import sys

import numpy as np
import one_material
import pytest
from spot_analysis.base.errors import AnalysisError
from spot_analysis.report import criteria
from spot_analysis.statistics import run_statistics

from conftest import script
from synthetic import write_plug_flow

TIMES = [0, 2, 4, 6, 8, 10, 14]  # DEM's; the deck has one every 2 tau


@pytest.fixture(scope="module")
def decks(tmp_path_factory):
    """DEM falls by a layer in 2 tau; seeds 1 and 2 of the deck by one and half a layer, whatever it is told."""
    folder = tmp_path_factory.mktemp("decks")
    dem = write_plug_flow(folder / "dem", 1.0, TIMES)
    assert script("measure.py", dem, "-o", folder / "dem.npz").returncode == 0
    runs = [write_plug_flow(folder / name, speed, range(0, 16, 2)) for name, speed in (("whole", 1.0), ("half", 0.5))]
    (folder / "lmp.py").write_text(
        "import os, shutil, sys\nword = lambda name: sys.argv[sys.argv.index(name) + 1]\n"
        f"print(' '.join(sys.argv[1:]), file=open({str(folder / 'called')!r}, 'a'))\n"
        f"shutil.copytree({runs!r}[int(word('seed')) - 1], word('out'))\n")
    return folder


@pytest.fixture
def call(decks, monkeypatch, capsys):
    """Runs one_material.py with one reference, the plug; returns what it printed."""
    reference = one_material.Reference(str(decks / "dem.npz"), 80.0, (str(decks / "dem.npz"),), variables={"half_width": "10"},
                                       windows={"early": (2.0, 10.0)}, not_carried={"flux_60d*": "too high"})
    monkeypatch.setattr(one_material, "REFERENCES", {"plug": reference})
    monkeypatch.setattr(one_material, "INGREDIENTS", {"wings": {"options": "wings no", "variables": {"feathers": "0"}}})

    def run(*words):
        monkeypatch.setattr(sys, "argv", ["one_material.py", "--lmp", f"{sys.executable} {decks / 'lmp.py'}", *map(str, words)])
        one_material.main()
        return capsys.readouterr().out
    return run


@pytest.fixture(scope="module")
def output(tmp_path_factory):
    return tmp_path_factory.mktemp("table")


def cells(text, name):
    return next(line for line in text.splitlines() if line.startswith(f"| {name} |")).strip("| ").split(" | ")


def test_table(call, decks, output):
    text = call("-o", output, "--seeds", 1, 2, "--jobs", 2)
    assert cells(text, "") == ["bound", "plug (early 2-10 tau)", "plug: DEM twin 1", "plug: nothing", "plug: kinematic"]
    outflow = cells(text, "outflow, early")
    assert outflow[2] == "60 +- 20 / 80 yes"  # 80 and 40: twice the error of their mean is 40
    assert outflow[3] == "80 / 80 yes" and outflow[4] == "0 / 80 **NO**"
    assert "flux_60d" not in text and "flux_30d_over_outflow, early" in text
    assert (output / "table.md").read_text() == text
    assert sorted(path.name for path in output.iterdir()) == ["plug.1.npz", "plug.2.npz", "plug.kinematic.npz", "plug.nothing.npz", "table.md"]
    np.testing.assert_allclose(run_statistics.load(output / "plug.2.npz").times, TIMES)
    asked = (decks / "called").read_text().splitlines()[0]
    for words in ("-var outflow 80", "-var half_width 10", "-var seed", f"-var time {14 * one_material.TAU:.9g}", "-var options accuracy normal "):
        assert words in asked + " "


def test_runs_are_kept(call, output):
    text = call("-o", output, "--seeds", 1, 2, "--lmp", "absent")
    assert text == (output / "table.md").read_text()
    one_seed = call("-o", output, "--seeds", 2, "--no-baselines", "--lmp", "absent")
    assert cells(one_seed, "outflow, early")[2] == "40 / 80 **NO**" and "nothing" not in one_seed


@pytest.mark.parametrize("words", [("--set", "radius=0.01"), ("--options", "dz 0.001"), ("--without", "wings")])
def test_runs_of_other_settings_are_not_taken_for_these(call, output, words):
    with pytest.raises(AnalysisError, match="plug.1.npz: made by another deck, with other variables"):
        call("-o", output, "--seeds", 1, *words)


def test_words_for_the_deck(call, decks, tmp_path):
    (decks / "called").unlink()
    call("-o", tmp_path, "--seeds", 1, "--no-baselines", "--without", "wings", "--options", "dz 0.001", "--set", "outflow=3", "influence=1e-3")
    asked = (decks / "called").read_text()
    for words in ("-var outflow 3 ", "-var influence 1e-3", "-var feathers 0", "-var options accuracy normal wings no dz 0.001 "):
        assert words in asked


@pytest.mark.parametrize("words, message", [
    (("--set", "radius"), "--set: 'radius' is not NAME=VALUE"), (("--set", "options=x"), "--set: 'options' is chosen here"),
    (("--set", "seed=1"), "--set: 'seed' is chosen here")])
def test_bad_settings(call, tmp_path, words, message):
    with pytest.raises(AnalysisError, match=message):
        call("-o", tmp_path, *words)


@pytest.mark.parametrize("words, message", [
    ((), "-o FOLDER is missing"), (("-o", "x", "--jobs", "0"), "--jobs is 0 but must be at least 1"),
    (("-o", "x", "--only", "another"), "invalid choice: 'another'"), (("-o", "x", "--without", "nobody"), "invalid choice: 'nobody'")])
def test_bad_words(words, message):
    done = script("one_material.py", *words)
    assert done.returncode == 2 and message in done.stderr


def test_a_run_that_fails(tmp_path):
    done = script("one_material.py", "-o", tmp_path, "--only", "walls-16", "--seeds", 1,
                  "--lmp", f"{sys.executable} -c 'import sys; sys.exit(\"ERROR: no\")'")
    assert done.returncode == 1 and done.stderr.strip().endswith("error: lmp failed on 'walls-16, seed 1': ERROR: no")


def test_rows(call):
    text = call("--rows")
    assert cells(text, "rate: outflow, early")[2] == "yes"
    assert cells(text, "volume: flux_60d_over_outflow, early")[2] == "- (2)"
    assert cells(text, "surface: surface_angle_20_40tau")[2] == "- (1)"
    assert text.endswith("1. the run ends at 14 tau\n2. too high\n") or "2. too high" in text
    assert len(text.splitlines()) >= len(criteria.CRITERIA)


@pytest.mark.parametrize("name", one_material.REFERENCES)
def test_references_carry_the_rows_that_they_are_said_to(name):
    """DEM against itself: each of these rows is known and within its bound."""
    dem = one_material.REFERENCES[name].load()[:1]
    verdicts = one_material.judge(name, dem, dem)
    carried = [one for one in criteria.CRITERIA if one_material.REFERENCES[name].why_not(one, dem[0]) is None]
    assert len(carried) > 8
    assert [one.label for one in carried if one.bound and verdicts[one].met is not True] == []
    assert [one.label for one in set(criteria.CRITERIA) - set(carried) if verdicts[one].met is not None] == []

