# SPDX-License-Identifier: GPL-2.0-or-later
"""Statistics of granular drainage from LAMMPS and LIGGGHTS dumps.

Rooms, from top to bottom: commands, report, calibration, statistics, reading, base. Each imports from itself and from those
below it only.

Reduced units throughout: lengths in grain diameters d, times in tau = sqrt(d/g), counts in grains.
The dump reader alone works in the dump's own units; ``reading.scene`` converts.
"""
