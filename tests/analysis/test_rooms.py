# SPDX-License-Identifier: GPL-2.0-or-later
"""Each room (folder) of the package imports from itself and from the rooms below it only, and no module from one that imports
it in turn; modules stay short."""

import ast

import pytest

from conftest import ANALYSIS

PACKAGE = ANALYSIS / "spot_analysis"
ROOMS = ("commands", "importing", "rendering", "report", "calibration", "statistics", "reading", "base")  # from top to bottom
LONGEST = 150  # lines
MODULES = {path.relative_to(PACKAGE).with_suffix("").parts: path for path in sorted(PACKAGE.rglob("*.py"))
           if path.name != "__init__.py"}


def imported(module, source):
    """Modules, as (room, name), that ``source``, the text of ``module``, imports from; an unknown one is returned as it is."""
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found.update(tuple(alias.name.split(".")[1:]) for alias in node.names if alias.name.split(".")[0] == PACKAGE.name)
        elif isinstance(node, ast.ImportFrom):
            words = tuple(node.module.split(".")) if node.module else ()
            if node.level:
                base = module[:-node.level] + words if node.level <= len(module) else ("outside", *words)
            elif words[:1] == (PACKAGE.name,):
                base = words[1:]
            else:
                continue
            found.update({(*base, alias.name) for alias in node.names} if len(base) < 2 else {base})
    return found


def faults(modules):
    """What breaks the order of the rooms; modules : (room, name) -> text."""
    found = []
    for module, source in modules.items():
        if len(module) != 2 or module[0] not in ROOMS:
            found.append(f"{module} is in no room")
            continue
        for other in imported(module, source):
            if other not in modules:
                found.append(f"{module} imports {other}, which is no module of a room")
            elif ROOMS.index(other[0]) < ROOMS.index(module[0]):
                found.append(f"{module} imports {other}, which is not below it")
    return found


def circles(modules):
    """Modules that import themselves through others."""
    reached = {module: imported(module, source) & set(modules) for module, source in modules.items()}
    for _ in modules:
        reached = {module: others.union(*(reached[other] for other in others)) for module, others in reached.items()}
    return sorted(module for module, others in reached.items() if module in others)


@pytest.fixture(scope="module")
def texts():
    assert len(MODULES) > 50
    return {module: path.read_text(encoding="utf-8") for module, path in MODULES.items()}


def test_rooms_import_downwards(texts):
    assert faults(texts) == []


def test_no_circles(texts):
    assert circles(texts) == []


def test_modules_are_short(texts):
    assert {module: lines for module, text in texts.items() if (lines := text.count("\n")) > LONGEST} == {}


@pytest.mark.parametrize("line", ["from ..report import table", "from ..report.table import cells", "import spot_analysis.report.table",
                                  "def f():\n    from spot_analysis.report import table", "from .. import report", "from ..attic import x"])
def test_an_import_upwards_is_found(line):
    modules = {("reading", "dump"): line, ("report", "table"): ""}
    assert len(faults(modules)) == 1
    assert faults({("reading", "dump"): "", ("report", "table"): "import os\nfrom ..reading.dump import read_file\nfrom ..reading import dump"}) == []


def test_a_circle_is_found():
    modules = {("base", "a"): "from . import b", ("base", "b"): "from .c import x", ("base", "c"): "from .a import y", ("base", "d"): "from .a import y"}
    assert circles(modules) == [("base", "a"), ("base", "b"), ("base", "c")]
