# SPDX-License-Identifier: GPL-2.0-or-later
"""Statistics of granular drainage from LAMMPS and LIGGGHTS dumps.

Reduced units throughout: lengths in grain diameters d, times in tau = sqrt(d/g), counts in grains.
The dump reader alone works in the dump's own units; ``scene`` converts.
"""
