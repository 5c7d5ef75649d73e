# SPDX-License-Identifier: GPL-2.0-or-later
"""Puts the analysis package on the path."""

import pathlib
import sys

ANALYSIS = pathlib.Path(__file__).resolve().parents[2] / "analysis"
sys.path.insert(0, str(ANALYSIS))
