# SPDX-License-Identifier: GPL-2.0-or-later
"""The guide's commands run, in the order of the page, and print what the page shows.

Blocks below a line `<!-- run -->` are run: lines that begin with `$ ` are commands, the others are what they print. There `...`
stands for whatever is left out, a line of it for any lines, and numbers may be others. All blocks of a page run one after the
other, from the root of a copy of the checkout, in which installing and building do nothing.
"""

import os
import pathlib
import re
import subprocess

import pytest

import documents
from documents import ROOT

LMP = pathlib.Path(os.environ.get("SPOT_LMP", ROOT / "build" / "bin" / "lmp"))
LINKED = ("analysis", "lammps-package", "docs", "README.md")
COPIED = ("examples", "scripts", "run.sh")
NOTHING = "#!/bin/sh\n"
DONE = "@@ done @@"


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


def walk(page):
    """(command, lines that it prints) of all blocks that are to be run."""
    steps = []
    for block in documents.blocks(page.read_text()):
        if block.mark != "run":
            continue
        for line in block.text.splitlines():
            if line.startswith("$ "):
                steps.append([line[2:], []])
            elif steps and not steps[-1][1] and _is_open(steps[-1][0]):
                steps[-1][0] += "\n" + line
            else:
                steps[-1][1].append(line)
    return steps


def _is_open(command):
    return command.endswith("\\") or command.count("'") % 2 == 1


NUMBER = r"[-+]?\d[\d.]*(?:e[-+]?\d+)?"


def expected(line):
    """A regular expression for a line as the page shows it."""
    parts = re.split(rf"(\.\.\.|{NUMBER}|\s+)", line.strip())
    return "".join(".*" if part == "..." else NUMBER if re.fullmatch(NUMBER, part) else r"\s+" if part.isspace() else re.escape(part)
                   for part in parts)


def missing_line(shown, printed):
    """The first shown line that was not printed, in this order; None if there is none."""
    k, anywhere = 0, False
    for line in shown:
        if line.strip() == "...":
            anywhere = True
            continue
        pattern = re.compile(expected(line))
        places = range(k, len(printed)) if anywhere else range(k, min(k + 1, len(printed)))
        k = next((n + 1 for n in places if pattern.fullmatch(printed[n].strip())), None)
        if k is None:
            return line
        anywhere = False
    return None


@pytest.mark.parametrize("page", ["first-run", "my-own-silo"])
def test_commands_of(page, checkout):
    steps = walk(ROOT / "docs" / f"{page}.md")
    assert len(steps) > 4
    script = "set -e -o pipefail\n" + "".join(f"{command}\necho; echo '{DONE}'\n" for command, _ in steps)
    done = subprocess.run(["bash", "-c", script], cwd=checkout, capture_output=True, text=True, timeout=900)
    printed = re.split(rf"\n?{DONE}\n", done.stdout)
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
