# SPDX-License-Identifier: GPL-2.0-or-later
"""one_factor.py on a plug that falls: table, its spread over seeds, and runs that are kept."""

import sys

import pytest

from conftest import script
from synthetic import write_plug_flow

TIMES = range(0, 26, 2)


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    """A deck whose seeds 1 and 2 fall by half a layer and a whole one in 2 tau; DEM falls by a layer."""
    folder = tmp_path_factory.mktemp("study")
    runs = [write_plug_flow(folder / name, speed, TIMES) for name, speed in (("slow", 0.5), ("fast", 1.0))]
    assert script("measure.py", runs[1], "-o", folder / "dem.npz").returncode == 0
    lmp = folder / "lmp.py"
    lmp.write_text("import shutil, sys\nword = lambda name: sys.argv[sys.argv.index(name) + 1]\n"
                   f"shutil.copytree({runs!r}[int(word('seed')) - 1], word('out'))\n")
    options = (folder / "dem.npz", "-o", folder / "out", "--seeds", 1, 2, "--only", "alpha 1.0")
    return folder, options, script("one_factor.py", *options, "--lmp", f"{sys.executable} {lmp}")


def test_table(study):
    folder, _, done = study
    assert done.returncode == 0, done.stderr
    heading, _, dem, row = (line.split(" | ") for line in done.stdout.splitlines())
    assert heading[1] == "outflow (1/tau)" and len(heading) == len(dem) == len(row)
    assert dem[:2] == ["| DEM", "80"] and row[:2] == ["| alpha 1.0", "60 +- 28"]  # 40 and 80
    assert sorted(path.name for path in (folder / "out").iterdir()) == ["alpha_1.0.1.npz", "alpha_1.0.2.npz"]


def test_runs_are_kept(study):
    _, options, done = study
    assert script("one_factor.py", *options, "--lmp", "absent").stdout == done.stdout


def test_time_and_dumps(study, tmp_path):
    folder, options, _ = study
    lmp = tmp_path / "lmp.py"
    lmp.write_text("import sys\nprint(sys.argv[sys.argv.index('time') + 1], file=open('" + str(tmp_path / "time") + "', 'w'))\n"
                   + (folder / "lmp.py").read_text())
    done = script("one_factor.py", options[0], "-o", tmp_path / "out", "--seeds", 1, "--only", "alpha 1.0", "--time", 26, "--dumps",
                      "--lmp", f"{sys.executable} {lmp}")
    assert done.returncode == 0, done.stderr
    assert float((tmp_path / "time").read_text()) == pytest.approx(26 * (0.003 / 9.81)**0.5)
    assert (tmp_path / "out" / "alpha_1.0.1" / "scene.json").exists()


def test_runs_with_other_included_files_are_others(tmp_path):
    from spot_analysis.commands.deck_run import settings_of

    deck, beads = tmp_path / "in.deck", tmp_path / "beads.lmp"
    deck.write_text("include beads.lmp # numbers\ninclude ${parameters}\nrun 1\n")
    beads.write_text("variable radius index 3\n")
    first = settings_of(str(deck), {})
    assert settings_of(str(deck), {}) == first
    beads.write_text("variable radius index 4\n")
    assert settings_of(str(deck), {}) != first


def test_failing_runs_are_refused(study, tmp_path):
    _, options, _ = study
    done = script("one_factor.py", options[0], "-o", tmp_path, "--seeds", 1,
                  "--lmp", f"{sys.executable} -c 'import sys; sys.exit(\"ERROR: no\")'")
    assert done.returncode == 1 and done.stderr.strip().endswith("error: lmp failed on 'the deck': ERROR: no")
