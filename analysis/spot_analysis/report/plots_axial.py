# SPDX-License-Identifier: GPL-2.0-or-later
"""Plot of how fast grains fall in a round hopper, as a function of the distance from its axis."""

import re

from matplotlib import pyplot as plt

from ..statistics.axial_flow import HEIGHTS
from .plot_style import STYLE


def _profile(found, height):
    """Distances from the axis (d), speeds (d/tau) and their standard errors at a height."""
    pattern = re.compile(rf"speed_{height:g}d_r([\d.]+)d")
    rows = [(float(match[1]), *value) for name, value in found.items() if (match := pattern.fullmatch(name))]
    return list(zip(*sorted(rows)))


def save_profiles(path, reference, spot):
    """Write the plot. reference, spot : quantity -> [value, standard error], as of ``axial_flow.measure``."""
    figure, axes = plt.subplots(1, len(HEIGHTS), figsize=(3.0 * len(HEIGHTS), 3.0), layout="constrained", sharex=True)
    for panel, height in zip(axes, reversed(HEIGHTS)):
        for label, found in (("DEM", reference), ("spot", spot)):
            distance, speed, error = _profile(found, height)
            panel.errorbar(distance, speed, error, linewidth=1, capsize=2, label=label, **STYLE[label])
        panel.set(title=f"{height:g} d above the outlet", xlabel="r (d)", ylim=(0, None))
    axes[0].set_ylabel("fall (d/tau)")
    axes[-1].legend(frameon=False)
    figure.savefig(path, dpi=110)
    plt.close(figure)
