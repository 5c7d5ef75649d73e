# SPDX-License-Identifier: GPL-2.0-or-later
"""The version, which stands in the file VERSION of the sources; where these are not, in what was installed."""

import importlib.metadata
import os

SOURCES = os.path.join(os.path.dirname(os.path.abspath(__file__)), *3 * [os.pardir])


def version():
    """Such as 0.1.0; unknown where the package is neither in its sources nor installed."""
    if os.path.isfile(os.path.join(SOURCES, "pyproject.toml")):
        with open(os.path.join(SOURCES, "VERSION"), encoding="ascii") as handle:
            return handle.read().strip()
    try:
        return importlib.metadata.version("spot-analysis")
    except importlib.metadata.PackageNotFoundError:
        return "unknown"
