#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""A dry run of a deck of fix spot: numbers with what they should be, and a picture of walls, outlets, grains and spots."""

from spot_analysis.base.interpreter import require_packages

require_packages("numpy", "scipy", "matplotlib", "zstandard")

from spot_analysis.commands.check_deck import main  # noqa: E402  (only after the check above)

if __name__ == "__main__":
    main()
