#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Draw runs side by side: one picture, PNG frames, an animation (GIF, WebP, MP4), or points for ParaView (VTK)."""

from spot_analysis.base.interpreter import require_packages

require_packages("numpy", "scipy", "matplotlib", "zstandard", "PIL")

from spot_analysis.commands.render import main  # noqa: E402  (only after the check above)

if __name__ == "__main__":
    main()
