# SPDX-License-Identifier: GPL-2.0-or-later
"""The picture of both silos: the layer of grains at the front wall."""

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.collections import EllipseCollection
from matplotlib.colors import to_rgba

LAYER_COLOURS = ["#1b4965", "#f4a259", "#5fa8d3", "#bc4b51", "#8cb369", "#5b3758"]
LATER_COLOUR = "0.7"  # of grains that were not there at the start


def silos(views):
    """The layers of both silos at the last time that both have a picture of; None if there is none."""
    dem, spot = (view.run for view in views.values())
    shared = [(i, j) for i, t in enumerate(dem.picture_times) for j, s in enumerate(spot.picture_times)
              if abs(t - s) < 0.05]
    if not shared:
        return None
    top = max(dem.levels[-1], spot.levels[-1]) + 2
    container = dem.scene.container()
    width = 2 * container.half_width + 4
    figure, axes = plt.subplots(1, 2, figsize=(8, 0.6 + 3.6 * top / width), sharey=True, constrained_layout=True)
    for axis, (name, view), index in zip(axes, views.items(), shared[-1]):
        _draw_silo(axis, view.run, index)
        axis.set_title(f"{name}, $t = {view.run.picture_times[index]:g}\\,\\tau$", fontsize=10)
        axis.set(xlim=(-width / 2, width / 2), ylim=(-2, top), xlabel="$x$ ($d$)", aspect="equal")
    axes[0].set_ylabel("$z$ ($d$)")
    return figure


def _draw_silo(axis, run, index):
    x, z, layer = run.picture(index)
    container = run.scene.container()
    colours = np.array([to_rgba(colour) for colour in LAYER_COLOURS])
    diameter = np.ones(len(x))
    fill = np.where((layer < 0)[:, None], to_rgba(LATER_COLOUR), colours[layer % len(colours)])
    axis.add_collection(EllipseCollection(
        diameter, diameter, 0 * diameter, units="x", offsets=np.column_stack([x, z]), transOffset=axis.transData,
        facecolors=fill, edgecolors="white", linewidths=0.15))
    wall = {"color": "black", "linewidth": 1.2}
    for side in (-1, 1):
        axis.plot([side * container.half_width] * 2, [0, run.levels[-1] + 2], **wall)
        axis.plot([side * container.orifice_radius, side * container.half_width], [0, 0], **wall)
