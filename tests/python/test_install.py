# SPDX-License-Identifier: GPL-2.0-or-later
"""What CMake installs: the Python module can be imported, and decks find what they include."""

import os
import pathlib
import subprocess
import sys


def test_the_installed_module_can_be_imported(tmp_path):
    component = pathlib.Path(os.environ["SPOT_BUILD"]) / "spot-core" / "python"
    subprocess.run([os.environ["SPOT_CMAKE"], "--install", component, "--prefix", tmp_path], check=True, capture_output=True)
    installed = tmp_path / os.environ["SPOT_PYTHON_INSTALL_DIR"]
    said = subprocess.run([sys.executable, "-c", "import spotcore; print(spotcore.__file__, spotcore.__version__)"],
                          env={**os.environ, "PYTHONPATH": str(installed)}, capture_output=True, text=True, check=True).stdout
    version = (pathlib.Path(__file__).resolve().parents[2] / "VERSION").read_text().split()[0]
    assert said.split() == [str(installed / "spotcore" / "__init__.py"), version]
    assert (installed / "spotcore" / "py.typed").exists() and (installed / "spotcore" / "__init__.pyi").exists()


def test_installed_decks_include_what_is_installed(tmp_path):
    build = pathlib.Path(os.environ["SPOT_BUILD"])
    subprocess.run([os.environ["SPOT_CMAKE"], "--install", build / "examples", "--prefix", tmp_path], check=True, capture_output=True)
    decks = list((tmp_path / "share" / "spot-drainage" / "examples").glob("*/in.*"))
    assert len(decks) > 8
    for deck in decks:
        commands = [line.split("#")[0] for line in deck.read_text().splitlines()]
        assert not [line for line in commands if "../" in line], deck
