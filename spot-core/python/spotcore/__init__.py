# SPDX-License-Identifier: GPL-2.0-or-later
"""Drains dense packings of grains with the spot model.

Lengths, times and accelerations are in any units that go together. z points up. Arrays are numpy's, and are copied
once on the way in and once on the way out. What is not allowed is refused by a ValueError that names the value and its
bound.

A box of grains of diameter 1, in units of tau = sqrt(diameter / gravity):

>>> import spotcore
>>> packing = spotcore.Packing(spotcore.lattice((-8, -5, 0), (8, 5, 15), 1.0), 0.5)
>>> drainage = spotcore.drain(packing, spotcore.Walls.box((-8, 8), (-5, 5)),
...                           [spotcore.Outlet.round((0, 0, 0), 4.0, outflow=40.0)],
...                           spotcore.Parameters.glass_beads(1.0, 1.0), 10.0)
>>> len(drainage.packing) + len(drainage.drained) == len(packing)
True
>>> drainage.packing.positions.shape == (len(drainage.packing), 3)
True
"""

from ._spotcore import (CollapsedPacking, Counters, Drainage, Drained, Outlet, Packing, Parameters, Progress, Shape,
                        Spots, Walls, __version__, drain, lattice)

__all__ = ["CollapsedPacking", "Counters", "Drainage", "Drained", "Outlet", "Packing", "Parameters", "Progress",
           "Shape", "Spots", "Walls", "__version__", "drain", "lattice"]
