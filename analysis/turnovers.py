#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Compare how a round bed is turned over, whose grains come in again on top: DEM and runs of the spot model."""

from spot_analysis.base.interpreter import require_packages

require_packages("numpy", "scipy", "matplotlib", "zstandard")

from spot_analysis.commands.turnovers import main  # noqa: E402  (only after the check above)

if __name__ == "__main__":
    main()
