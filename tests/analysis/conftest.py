# SPDX-License-Identifier: GPL-2.0-or-later
"""Puts the analysis package on the path, and runs its scripts."""

import pathlib
import subprocess
import sys

ANALYSIS = pathlib.Path(__file__).resolve().parents[2] / "analysis"
sys.path.insert(0, str(ANALYSIS))


def script(name, *arguments):
    """The finished process of a script of analysis/, with what it printed as text."""
    return subprocess.run([sys.executable, "-B", str(ANALYSIS / name), *map(str, arguments)], capture_output=True, text=True)
