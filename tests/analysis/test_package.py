# SPDX-License-Identifier: GPL-2.0-or-later
"""The analysis as an installed package, without network, as its README says."""

import json
import os
import pathlib
import shutil
import subprocess
import sys

import pytest

from conftest import ANALYSIS
from synthetic import SCENE, frame_text, write_text

SOURCES = pathlib.Path(__file__).resolve().parents[2]
VERSION = (SOURCES / "VERSION").read_text().strip()


def missing_modules():
    """What Debian's python3-venv brings, where it is missing."""
    code = "import importlib.util as u; print(*[name for name in ('venv', 'ensurepip') if u.find_spec(name) is None])"
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip()


pytestmark = pytest.mark.skipif(missing_modules() != "", reason=f"{sys.executable} has no {missing_modules()}; "
                                "on Debian: apt install python3-venv")


def run(*words, **options):
    environment = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "PYTHONHOME")}
    done = subprocess.run(list(map(str, words)), capture_output=True, text=True, env={**environment, "PIP_NO_INDEX": "1"}, **options)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """The bin folder of a virtual environment that has it; pip writes beside the sources, so these are copied."""
    folder = tmp_path_factory.mktemp("package")
    sources = folder / "sources"
    sources.mkdir()
    for name in ("pyproject.toml", "VERSION"):
        shutil.copy(SOURCES / name, sources)
    shutil.copytree(ANALYSIS, sources / "analysis", ignore=shutil.ignore_patterns("__pycache__", "*.egg-info"))
    run(sys.executable, "-m", "venv", "--system-site-packages", folder / "venv")
    run(folder / "venv" / "bin" / "pip", "install", "--no-build-isolation", "--no-deps", ".", cwd=sources)
    return folder / "venv" / "bin"


def test_every_module_is_there_in_the_one_version(installed, tmp_path):
    code = ("import importlib.metadata, pathlib, spot_analysis; print(importlib.metadata.version('spot-analysis'));"
            "print(pathlib.Path(spot_analysis.__file__).parent)")
    version, folder = run(installed / "python", "-c", code, cwd=tmp_path).splitlines()
    assert version == VERSION
    assert pathlib.Path(folder).is_relative_to(installed.parent)
    here, there = ({path.relative_to(place) for path in pathlib.Path(place).rglob("*.py")}
                   for place in (ANALYSIS / "spot_analysis", folder))
    assert here == there


@pytest.mark.skipif("SPOT_VERSION" not in os.environ, reason="ctest sets SPOT_VERSION to what CMake has")
def test_cmake_has_this_version():
    assert os.environ["SPOT_VERSION"] == VERSION


def test_commands(installed, tmp_path):
    (tmp_path / "scene.json").write_text(json.dumps(SCENE))
    write_text(tmp_path / "a.dump", "".join(frame_text(step, [1, 2], [[0, 0, 1], [0, 0, 3]]) for step in (0, 200)))
    assert "2 snapshots" in run(installed / "spot-measure", tmp_path, "-o", tmp_path / "a.npz")
    assert "grains_initial" in run(installed / "spot-compare", tmp_path / "a.npz", tmp_path, "-o", tmp_path / "out")
    assert (tmp_path / "out" / "report.html").exists()
    assert run(installed / "spot-render", tmp_path, "-o", tmp_path / "a.png", "--slice", "-1", "1") == ""
    assert (tmp_path / "a.png").exists()
    (tmp_path / "beads.txt").write_text("0 0 0.5 0.5\n0 1 0.5 0.5\n")
    words = [tmp_path / "beads.txt", *"--box -2 2 -2 2 --orifice 1 --lammps-files".split(), SOURCES / "lammps-package", "-o", tmp_path / "own"]
    assert "2 grains of 1 m" in run(installed / "spot-import", *words)
    deck = (tmp_path / "own" / "in.spot").read_text()
    assert f"include   {SOURCES}/lammps-package/glass-beads.lmp" in deck and deck.startswith(f"# Made by spot-import {VERSION} from ")
    absent = subprocess.run([installed / "spot-check", tmp_path / "absent"], capture_output=True, text=True)
    assert absent.returncode == 1 and absent.stderr == f"error: {tmp_path / 'absent'}: no such file\n"
    refused = subprocess.run([installed / "spot-calibrate", tmp_path / "a.npz"], capture_output=True, text=True)
    assert refused.returncode == 1 and refused.stderr.startswith("error: too few snapshots")
