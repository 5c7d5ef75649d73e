# SPDX-License-Identifier: GPL-2.0-or-later
"""The guide's commands run, in the order of the page, and print what the page shows (walking.py): from the root of a copy of the
checkout, in which installing and building do nothing. walk_in_debian.py does it all, as a new user does.
"""

import os
import pathlib
import subprocess

import pytest

from documents import ROOT
from walking import missing_line, outputs, script_of, walk

LMP = pathlib.Path(os.environ.get("SPOT_LMP", ROOT / "build" / "bin" / "lmp"))
LINKED = ("analysis", "lammps-package", "docs", "README.md")
COPIED = ("examples", "scripts", "run.sh")
NOTHING = "#!/bin/sh\n"


@pytest.fixture
def checkout(tmp_path):
    for entry in LINKED:
        (tmp_path / entry).symlink_to(ROOT / entry)
    for entry in COPIED:
        subprocess.run(["cp", "-r", ROOT / entry, tmp_path / entry], check=True)
    for entry in ("install-packages.sh", "build.sh"):
        (tmp_path / "scripts" / entry).write_text(NOTHING)
    (tmp_path / "build" / "bin").mkdir(parents=True)
    (tmp_path / "build" / "bin" / "lmp").symlink_to(LMP)
    return tmp_path


@pytest.mark.parametrize("page", ["first-run", "my-own-silo"])
def test_commands_of(page, checkout):
    steps = walk(ROOT / "docs" / f"{page}.md", ["run"])
    assert len(steps) > 4
    done = subprocess.run(["bash", "-c", script_of(steps)], cwd=checkout, capture_output=True, text=True, timeout=900)
    printed = outputs(done.stdout)
    assert done.returncode == 0, f"{steps[len(printed) - 1][0]} failed: {printed[-1][-1500:]} {done.stderr[-1500:]}"
    for (command, shown), output in zip(steps, printed):
        line = missing_line(shown, output.splitlines())
        assert line is None, f"{command} did not print '{line}', but\n{output[:3000]}"


def test_lines_are_compared():
    printed = ["Step   Atoms", "0  8000 1.5e-05", "report: /a/b/results/x.html"]
    assert missing_line(["Step Atoms", "  7 9 2e-5", "..."], printed) is None
    assert missing_line(["...", "report: .../results/x.html"], printed) is None
    assert missing_line(["report: .../results/x.html"], printed) == "report: .../results/x.html"
    assert missing_line(["...", "Steps Atoms"], printed) == "Steps Atoms"
    assert missing_line(["Step Atoms", "...", "x 8000 1"], printed) == "x 8000 1"
