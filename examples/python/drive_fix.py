# SPDX-License-Identifier: GPL-2.0-or-later
"""Drains the hopper of examples/own-hopper by fix spot, from LAMMPS' Python module; prints it every 5 tau."""
import lammps
import numpy as np

deck = open("../own-hopper/in.own").read().replace("packing.data.gz", "../own-hopper/packing.data.gz")
lmp = lammps.lammps(cmdargs=["-log", "none", "-screen", "none"])
lmp.commands_string(deck[: deck.index("dump ")])  # no dump, no run; in it, load_spot.lmp loads the plugin

for _ in range(4):
    lmp.command("run 10 post no")  # 10 steps of tau / 2
    tau = lmp.extract_variable("tau")
    drained = lmp.extract_fix("drain", lammps.LMP_STYLE_GLOBAL, lammps.LMP_TYPE_VECTOR, 2)
    z = lmp.numpy.extract_atom("x")[: lmp.extract_global("nlocal"), 2]
    print(f"{lmp.extract_global('atime') / tau:5.1f} tau: {drained:5.0f} grains have left, {len(z)} are there, "
          f"the highest at {np.max(z) / lmp.extract_variable('d'):.1f} d")
