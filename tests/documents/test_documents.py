# SPDX-License-Identifier: GPL-2.0-or-later
"""Documents are as short as people read, and name only what is there."""

import re
import subprocess
import sys
import urllib.parse

import pytest

import documents
from documents import ROOT, name

every_document = pytest.mark.parametrize("path", documents.documents(), ids=name)
every_readme = pytest.mark.parametrize("path", [p for p in documents.documents() if p.name == "README.md"], ids=name)

ROOMS = ROOT / "spot-core" / "include", ROOT / "spot-core" / "include" / "spot", ROOT / "analysis" / "spot_analysis"
LINE, COLUMNS, WORDS, WORDS_OF_THE_FIRST = 120, 6, 900, 600


def test_there_are_documents():
    assert {"README.md", "ARCHITECTURE.md", "docs/index.md", "lammps-package/doc/fix_spot.rst"} <= set(map(name, documents.documents()))


@every_document
def test_lines(path):
    too_long = [k for k, line in enumerate(path.read_text().splitlines(), 1) if len(line) > LINE]
    assert not too_long, f"lines of more than {LINE} characters: {too_long}"


@every_document
def test_tables(path):
    wide = [line for line, columns in documents.tables(path, path.read_text()) if columns > COLUMNS]
    assert not wide, f"tables of more than {COLUMNS} columns, in lines {wide}"


@every_readme
def test_words(path):
    words, bound = len(path.read_text().split()), WORDS_OF_THE_FIRST if path.parent == ROOT else WORDS
    assert words <= bound, f"{words} words, at most {bound} are allowed: a page in docs can take the rest"


@every_document
def test_links(path):
    """Relative ones lead to a file, and to a heading of it."""
    if path.suffix == ".rst":
        return
    text, broken = path.read_text(), []
    for line, target in documents.links(text):
        parts = urllib.parse.urlsplit(target)
        if parts.scheme:
            continue
        to = path.parent / urllib.parse.unquote(parts.path) if parts.path else path
        if not to.exists():
            broken.append((line, target))
        elif parts.fragment and parts.fragment not in documents.anchors(to.read_text()):
            broken.append((line, target))
    assert not broken, f"links that lead nowhere: {broken}"


@every_document
def test_files(path):
    """What stands in backticks and looks like the path of a file, is one: from the document's folder, the root, or that of the
    rooms. What is built or written by a run need not be there, nor what somebody may add as NAME."""
    missing = []
    for line, words in documents.in_backticks(path.read_text()):
        if not re.fullmatch(r"[\w.-]+(/[\w.-]+)*/[\w.-]+\.\w+", words.removeprefix("../").removeprefix("../")):
            continue
        if re.match(r"(\.\./)*(build|results|post|venv|usr|PREFIX|LAMMPS|PROJECT|OUT)\b", words) or "NAME" in words:
            continue
        if not any((folder / words).exists() for folder in (path.parent, ROOT, *ROOMS)):
            missing.append((line, words))
    assert not missing, f"files that are not there: {missing}"


_HELP = {}


def help_of(script):
    if script not in _HELP:
        program = ["bash"] if script.suffix == ".sh" else [sys.executable, "-B"]
        done = subprocess.run([*program, str(script), "--help"], capture_output=True, text=True, timeout=60, cwd=ROOT)
        assert done.returncode == 0, f"{name(script)} --help: {done.stderr[-300:]}"
        _HELP[script] = done.stdout
    return _HELP[script]


@every_document
def test_commands(path):
    """Scripts of ours are there, and know the options that they are shown with."""
    wrong = []
    for block in documents.blocks(path.read_text()):
        for line in documents.command_lines(block):
            found = documents.script_and_options(path, line)
            if found is None:
                continue
            word, script, options = found
            if script is None:
                wrong.append(f"line {block.first_line}: there is no {word}")
                continue
            for option in options:
                if not re.search(rf"(?<![\w-]){re.escape(option)}(?![\w-])", help_of(script)):
                    wrong.append(f"line {block.first_line}: {word} has no {option}")
    assert not wrong, "; ".join(wrong)


def test_parameters_are_all_there():
    """The page on them has a line for each keyword of fix spot."""
    syntax = (ROOT / "lammps-package" / "doc" / "fix_spot.rst").read_text().partition("* keyword = ")[2].partition("\n\n")[0]
    keywords = re.findall(r"\*(\w+)\*", syntax)
    assert len(keywords) > 30
    rows = [line for line in (ROOT / "docs" / "parameters.md").read_text().splitlines() if line.startswith("|")]
    missing = [keyword for keyword in keywords if not any(f"| `{keyword}` |" in row for row in rows)]
    assert not missing, f"docs/parameters.md has no line for {missing}"


def test_changes_are_of_this_version():
    version = (ROOT / "VERSION").read_text().strip()
    newest = re.search(r"^## (\S+?),? ", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE).group(1)
    assert newest == version


def test_figures_agree():
    """The page on how good the model is has the README's table."""
    table = (ROOT / "README.md").read_text().partition("## How good")[2].partition("\n## ")[0]
    rows = [line for line in table.splitlines() if line.startswith("| ")]
    assert len(rows) > 5
    page = (ROOT / "docs" / "how-good-how-fast.md").read_text()
    assert not [row for row in rows if row not in page]


def test_commands_are_found():
    """The test above sees what it should."""
    readme = ROOT / "README.md"
    assert documents.script_and_options(readme, "nice -n 10 /usr/bin/python3 ../../analysis/compare.py A B --from 40 -o x") is None
    line = "/usr/bin/python3 ../../analysis/compare.py A B --from 40 -o x  # words"
    assert documents.script_and_options(readme, line) == ("../../analysis/compare.py", ROOT / "analysis" / "compare.py", ["--from", "-o"])
    assert documents.script_and_options(readme, "./gone.sh --x") == ("./gone.sh", None, ["--x"])
    assert documents.script_and_options(readme, "spot-render a") == ("spot-render", ROOT / "analysis" / "render.py", [])
    assert documents.script_and_options(readme, "lmp -in in.own") is None


def test_pictures_have_their_command():
    """scripts/pictures.sh makes each picture that documents show."""
    made, here = set(), ""
    for line in (ROOT / "scripts" / "pictures.sh").read_text().splitlines():
        if found := re.search(r"\bhere=(\S+)", line):
            here = found.group(1)
        made |= set(re.findall(r"[\w./-]+\.(?:png|webp)\b", line.replace("$here", here)))
    shown = {name((path.parent / target).resolve()) for path in documents.documents() if path.suffix == ".md"
             for _, target in documents.links(path.read_text()) if re.search(r"\.(png|webp|gif|svg|jpg)$", target)}
    assert "docs/pictures/silo.webp" in shown
    assert not shown - made, f"scripts/pictures.sh does not make {sorted(shown - made)}"
