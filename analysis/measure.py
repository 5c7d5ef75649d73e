#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Measure the dumps of a run and store the statistics, so that compare.py needs no dumps."""

from spot_analysis.base.interpreter import require_packages

require_packages("numpy", "scipy", "zstandard")

from spot_analysis.commands.measure import main  # noqa: E402  (only after the check above)

if __name__ == "__main__":
    main()
