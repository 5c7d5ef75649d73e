#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Compare a spot run with a DEM run: one table, comparison.json, plots and a report in HTML."""

from spot_analysis.base.interpreter import require_packages

require_packages("numpy", "scipy", "matplotlib", "zstandard")

from spot_analysis.commands.compare import main  # noqa: E402  (only after the check above)

if __name__ == "__main__":
    main()
