# SPDX-License-Identifier: GPL-2.0-or-later
"""Plot of how a round container drains to its end: grains that are left through time, and its surface along r."""

import math
import re

from matplotlib import pyplot as plt

from .plot_style import STYLE


def _rows(found, pattern):
    """Columns of (number in the name, value, error or 0), in the order of the numbers."""
    rows = [(float(match[1]), value, error if math.isfinite(error) else 0.0)
            for name, (value, error) in found.items() if (match := re.fullmatch(pattern, name))]
    return list(zip(*sorted(rows)))


def save_drainage(path, reference, spot, moments):
    """Write the plot.

    reference, spot : quantity -> [value, standard error], as of ``round_heap.measure``
    moments : of the surfaces, as they are named there
    """
    figure, axes = plt.subplots(1, 1 + len(moments), figsize=(2.6 * (1 + len(moments)), 2.8), layout="constrained")
    for label, found in (("DEM", reference), ("spot", spot)):
        for panel, pattern in zip(axes, [r"left_([\d.]+)tau", *(rf"surface_{moment}_r([\d.]+)d" for moment in moments)]):
            if rows := _rows(found, pattern):
                panel.errorbar(*rows, linewidth=1, capsize=2, label=label, **STYLE[label])
    axes[0].set(title="grains left", xlabel="t (tau)", ylim=(0, None))
    top = max(panel.get_ylim()[1] for panel in axes[1:])
    for panel, moment in zip(axes[1:], moments):
        panel.set(title=f"surface, {moment.replace('tau', ' tau')}", xlabel="r (d)", ylim=(0, top))
    axes[1].set_ylabel("height (d)")
    axes[0].legend(frameon=False)
    figure.savefig(path, dpi=100)
    plt.close(figure)
