# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures of every fit of a calibration, each a function from Measured to a matplotlib figure."""

import os

import numpy as np
from matplotlib import pyplot as plt

from ..calibration.correlation import TOUCHING
from ..calibration.estimate import combine
from ..statistics.counts import SLAB, slab_counts
from ..statistics.particle_diffusion import DROPS

DATA = {"color": "#1b4965", "marker": "o", "markersize": 3.5, "linestyle": "none", "capsize": 2, "linewidth": 1}
FIT, SECOND_FIT = {"color": "#d1495b"}, {"color": "#f4a259", "linestyle": "--"}


def draw(folder, measured):
    """Write every picture to ``folder``; returns their paths."""
    paths = []
    for picture in (correlation, spreading, profiles, diffusion, flow):
        figure = picture(measured)
        paths.append(os.path.join(folder, f"{picture.__name__}.png"))
        figure.savefig(paths[-1], dpi=130)
        plt.close(figure)
    return paths


def correlation(measured):
    """C(r), the form of intersecting spheres, and 2006's exponential."""
    found = measured.correlation
    figure, axis = plt.subplots(figsize=(6, 4), constrained_layout=True)
    axis.errorbar(found.distance, found.curve.value, found.curve.error, label="measured", **DATA)
    axis.plot(found.distance, found.form, label=f"spheres between walls, radius {_text(found.radius)} $d$", **FIT)
    axis.plot(found.distance, found.decay.value[0] * np.exp(-found.distance / found.decay.value[1]),
              label=rf"exponential, $\beta$ = {_text(found.decay[1])} $d$", **SECOND_FIT)
    axis.axvspan(found.distance[0] - 0.2, TOUCHING, color="0.92", zorder=0)
    axis.axhline(float(found.background.value), color="0.6", linewidth=0.8, linestyle=":")
    axis.set(xlabel="$r$ ($d$)", ylabel="$C(r)$", xlim=(found.distance[0] - 0.2, 6.1),
             title="grey: not fitted; dotted: background")
    axis.set_ylim(min(0, axis.get_ylim()[0]), None)
    axis.title.set_fontsize(9)
    axis.legend(frameon=False)
    return figure


def spreading(measured):
    """Variance of the spots against height, with its line."""
    found = measured.spreading
    figure, axis = plt.subplots(figsize=(6, 4), constrained_layout=True)
    reach = np.array([0, found.heights[-1] * 1.05])
    axis.errorbar(found.heights, found.variance.value, found.variance.error, label="of spots between walls", **DATA)
    slope, intercept = found.line.value
    axis.plot(reach, intercept + slope * reach, label=f"slope/2 = {_text(found.diffusion)} $d$", **FIT)
    axis.set(xlabel="$z$ ($d$)", ylabel="variance of the $v_z$ profile ($d^2$)", xlim=(0, None))
    axis.legend(frameon=False)
    return figure


def profiles(measured):
    """v_z across x at each height, with the curve of the spots between walls."""
    found = measured.spreading
    columns = 3
    rows = -(-len(found.heights) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(9, 2.3 * rows), sharex=True, squeeze=False, constrained_layout=True)
    for axis in axes.flat[len(found.heights):]:
        axis.set_visible(False)
    for row, (axis, height) in enumerate(zip(axes.flat, found.heights)):
        axis.errorbar(found.centres, found.profiles.value[row], found.profiles.error[row], **{**DATA, "markersize": 2})
        axis.plot(found.centres, found.fitted[row], **FIT)
        axis.set_title(f"$z = {height:g}\\,d$", fontsize=9)
        axis.set_ylim(0, None)
    for axis in axes[-1]:
        axis.set_xlabel("$x$ ($d$)")
    for axis in axes[:, 0]:
        axis.set_ylabel(r"$-v_z$ ($d/\tau$)")
    return figure


def diffusion(measured):
    """Var(dx) against the drop."""
    found = measured.diffusion
    figure, axis = plt.subplots(figsize=(6, 4), constrained_layout=True)
    axis.errorbar(DROPS, 1e3 * found.variance.value, 1e3 * found.variance.error, label="measured", **DATA)
    reach = DROPS[[0, -1]]
    axis.plot(reach, 1e3 * (found.line.value[1] + found.line.value[0] * reach), label="$2 b_p\\,\\Delta z$ + const, "
              f"$b_p$ = ({1e3 * found.length.value:.2f} $\\pm$ {1e3 * found.length.error:.2f}) $10^{{-3}} d$", **FIT)
    axis.set(xlabel=r"drop $\Delta z$ ($d$)", ylabel=r"Var$(\Delta x)$ ($10^{-3} d^2$)", xlim=(0, None), ylim=(0, None))
    axis.legend(frameon=False)
    return figure


def flow(measured):
    """Outflow and grains in the slab against time, and the front that spots raise."""
    run, span = measured.view.run, measured.view.interval.span
    shown = slice(measured.view.snapshots[-1] + 1)
    times = run.times[shown]
    figure, (out, slab, front) = plt.subplots(1, 3, figsize=(11, 3.4), constrained_layout=True)
    left = run.count_above(0)[shown]
    out.plot((times[1:] + times[:-1]) / 2, -np.diff(left) / np.diff(times), color=DATA["color"], marker=".", linewidth=0.8)
    _level(out, span, measured.outflow, r"$F$ = {}$/\tau$")
    out.set(xlabel=r"time ($\tau$)", ylabel=r"outflow (1/$\tau$)", ylim=(0, 1.1 * out.get_ylim()[1]))
    counts = slab_counts(run)[shown]
    slab.plot(times, counts, color=DATA["color"], marker=".", linewidth=0.8)
    mean = combine(lambda drop: counts[0] - drop, measured.drop)
    _level(slab, span, mean, f"{{}}\n$v_s$ = {_text(measured.speed)} $d/\\tau$")
    slab.set(xlabel=r"time ($\tau$)", ylabel=f"grains in {SLAB[0]} $d$ < z < {SLAB[1]} $d$")
    if measured.front:
        found = measured.front
        front.plot(found.arrivals, found.heights, color=DATA["color"], marker="o", linestyle="none")
        middle = np.array([found.arrivals.mean(), found.heights.mean()])
        reach = np.array([found.arrivals[0], found.arrivals[-1]])
        front.plot(reach, middle[1] + found.speed * (reach - middle[0]),
                   label=f"{found.speed:.2f} $\\pm$ {found.error:.2f} $d/\\tau$", **FIT)
        front.legend(frameon=False)
    front.set(xlabel=r"arrival of half the outflow ($\tau$)", ylabel="$z$ ($d$)", xlim=(0, None), ylim=(0, None))
    return figure


def _level(axis, span, estimate, label):
    axis.plot(span, [estimate.value] * 2, label=label.format(_text(estimate)), linewidth=2, **FIT)
    axis.legend(frameon=False, fontsize=8)


def _text(estimate):
    """Value and error with two digits of the error."""
    digits = max(0, 1 - int(np.floor(np.log10(estimate.error)))) if estimate.error > 0 else 3
    return f"{float(estimate.value):.{digits}f} $\\pm$ {float(estimate.error):.{digits}f}"
