# SPDX-License-Identifier: GPL-2.0-or-later
"""Plot of how fast grains fall, as a function of the distance from the axis of a hopper, or of the place along x in a box."""

from matplotlib import pyplot as plt

from .by_name import curve
from .plot_style import STYLE


def save_profiles(path, reference, spot, heights, place):
    """Write the plot.

    reference, spot : quantity -> [value, standard error], as of ``axial_flow.measure`` or ``box_flow.measure``
    heights : d, of the profiles; place : what their names have before the place, r or x
    """
    figure, axes = plt.subplots(1, len(heights), figsize=(3.0 * len(heights), 3.0), layout="constrained", sharex=True)
    for panel, height in zip(axes, reversed(heights)):
        for label, found in (("DEM", reference), ("spot", spot)):
            at, speed, error = curve(found, rf"speed_{height:g}d_{place}(-?[\d.]+)d")
            panel.errorbar(at, speed, error, linewidth=1, capsize=2, label=label, **STYLE[label])
        panel.set(title=f"{height:g} d above the outlet", xlabel=f"{place} (d)", ylim=(0, None))
    axes[0].set_ylabel("fall (d/tau)")
    axes[-1].legend(frameon=False)
    figure.savefig(path, dpi=110)
    plt.close(figure)
