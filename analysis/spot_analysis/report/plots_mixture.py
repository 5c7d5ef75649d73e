# SPDX-License-Identifier: GPL-2.0-or-later
"""Plot of how fast a mixture of sizes falls, as a function of the distance from the middle, and of what leaves through time."""

from matplotlib import pyplot as plt

from ..statistics.mixture import HEIGHTS
from .by_name import curve
from .plot_style import STYLE


def save(path, reference, spot):
    """Write the plot. reference, spot : quantity -> [value, standard error], as of ``mixture.measure``."""
    figure, axes = plt.subplots(1, len(HEIGHTS) + 1, figsize=(3.2 * (len(HEIGHTS) + 1), 3.0), layout="constrained")
    for label, found in (("DEM", reference), ("spot", spot)):
        for panel, height in zip(axes, HEIGHTS):
            panel.errorbar(*curve(found, rf"speed_{height:g}d_x([\d.]+)d"), linewidth=1, capsize=2, label=label, **STYLE[label])
            panel.set(title=f"{height:g} d up", xlabel="|x| (d)", ylabel="fall (d/tau)", ylim=(0, None))
        time, share, _ = curve(found, r"large_share_left_at_(\d+)tau")
        axes[-1].plot(time, share, label=label, **STYLE[label])
    axes[-1].set(title="what leaves", xlabel="t (tau)", ylabel="volume of large over all", ylim=(0, 1))
    axes[-1].legend(frameon=False)
    figure.savefig(path, dpi=110)
    plt.close(figure)
