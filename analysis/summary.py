#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Measure what a scene has, or compare it, whatever the scene."""

from spot_analysis.base.interpreter import require_packages

require_packages("numpy", "scipy", "matplotlib", "zstandard")

from spot_analysis.commands.summary import main  # noqa: E402  (only after the check above)

if __name__ == "__main__":
    main()
