# SPDX-License-Identifier: GPL-2.0-or-later
"""Plot of a bed that is turned over: how long grains stay, and how fast they fall where."""

from matplotlib import pyplot as plt

from ..statistics.turnovers import HEIGHTS
from .by_name import curve
from .plot_style import STYLE


def save(path, reference, spot):
    """Write the plot; reference, spot : quantity -> [value, standard error], as of ``turnovers.measure``"""
    figure, axes = plt.subplots(1, 1 + len(HEIGHTS), figsize=(3.6 * (1 + len(HEIGHTS)), 3.3), layout="constrained")
    panels = [(r"residence_density_([\d.]+)", axes[0]), *((rf"fall_{height:g}d_r([\d.]+)d", panel) for height, panel in zip(HEIGHTS, axes[1:]))]
    for label, found in (("DEM", reference), ("spot", spot)):
        for names, panel in panels:
            panel.errorbar(*curve(found, names), linewidth=1, capsize=2, label=label, **STYLE[label])
    axes[0].set(xlabel="time from coming in to draining (turnovers)", ylabel="density", ylim=(0, None))
    for height, panel in zip(HEIGHTS, axes[1:]):
        panel.set(title=f"{height:g} d above the outlet", xlabel="r (d)", ylabel="fall (d a turnover)", ylim=(0, None))
    axes[-1].legend(frameon=False)
    figure.savefig(path, dpi=110)
    plt.close(figure)
