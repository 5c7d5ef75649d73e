#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Compare how a round container drains to its end, and the heap that stays in it: DEM and runs of the spot model."""

from spot_analysis.base.interpreter import require_packages

require_packages("numpy", "matplotlib", "zstandard")

from spot_analysis.commands.round_heap import main  # noqa: E402  (only after the check above)

if __name__ == "__main__":
    main()
