#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Make a data file and a deck of fix spot from a packing of LIGGGHTS, LAMMPS, YADE, or plain columns."""

from spot_analysis.base.interpreter import require_packages

require_packages("numpy", "scipy", "zstandard")

from spot_analysis.commands.import_packing import main  # noqa: E402  (only after the check above)

if __name__ == "__main__":
    main()
