# SPDX-License-Identifier: GPL-2.0-or-later
"""Statistics of granular drainage from LAMMPS and LIGGGHTS dumps.

Rooms, from top to bottom: commands, importing, rendering, report, calibration, statistics, reading, base. Each imports from
itself and from those below it only.

Reduced units throughout: lengths in grain diameters d, times in tau = sqrt(d/g), counts in grains.
The dump reader alone works in the dump's own units; ``reading.scene`` converts.

``measure``, ``numbers`` and ``picture`` take arrays, in place of files; ``commands.arrays`` has them.
"""


def __getattr__(name):
    """What needs numpy and its like is imported when it is asked for: scripts say first which packages are missing."""
    if name in ("measure", "numbers", "picture"):
        from .commands import arrays
        return getattr(arrays, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
