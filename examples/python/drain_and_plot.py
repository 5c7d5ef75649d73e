# SPDX-License-Identifier: GPL-2.0-or-later
"""Drains the hopper of examples/own-hopper for 20 tau, and draws a slice through its middle: drain_and_plot.png."""
import matplotlib.pyplot as plt
import numpy as np
import spotcore
from spotcore import Outlet, Packing, Parameters, Shape, Walls

d, tau = 0.003, (0.003 / 9.81) ** 0.5  # m, s
start = np.loadtxt("../own-hopper/packing.data.gz", skiprows=11, usecols=(4, 5, 6))
hopper = Shape.cone((0, 0, 0), 0.012, (0, 0, 0.045), 0.03) | Shape.cylinder((0, 0, 0.045), (0, 0, 0.2), 0.03)
outlet = Outlet.round((0, 0, 0), 0.012, outflow=5700.0)  # grains a second, as in in.own
drainage = spotcore.drain(Packing(start, d / 2), Walls.inside(hopper), [outlet],
                          Parameters.glass_beads(d, tau), 20 * tau)
left = drainage.packing
(x, y, z), layer = left.positions.T / d, start[left.ids - 1, 2] // (3 * d)
middle = abs(y) < 0.5
plt.figure(figsize=(4, 5)).add_subplot(aspect="equal", xlabel="x / d", ylabel="z / d").scatter(
    x[middle], z[middle], 70, layer[middle] % 2, cmap="cividis", edgecolors="white", linewidths=0.5)
plt.savefig("drain_and_plot.png", dpi=90, bbox_inches="tight")
