# SPDX-License-Identifier: GPL-2.0-or-later
"""What the Python that runs a script must offer. Imports nothing but the standard library."""

import importlib.util
import sys

PACKAGES = {"numpy": "python3-numpy", "scipy": "python3-scipy", "matplotlib": "python3-matplotlib",
            "zstandard": "python3-zstandard", "PIL": "python3-pil"}


def require_packages(*modules):
    """Exit with one line if a module of PACKAGES cannot be imported by this interpreter."""
    missing = [module for module in modules if importlib.util.find_spec(module) is None]
    if missing:
        sys.exit(
            f"error: {sys.executable} has no {' or '.join(missing)}; use Debian's /usr/bin/python3 "
            f"with the packages {' '.join(PACKAGES[module] for module in missing)}"
        )
