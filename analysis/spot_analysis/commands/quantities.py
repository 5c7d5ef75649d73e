# SPDX-License-Identifier: GPL-2.0-or-later
"""Quantities, name -> [value, error], of a reference and of several runs, side by side."""

import math


def pooled(runs):
    """Mean over runs, with the standard error over them where there are several."""
    pooled = {}
    for name in runs[0]:
        values = [run.get(name, [math.nan, math.nan]) for run in runs]
        mean = sum(value for value, _ in values) / len(values)
        spread = math.sqrt(sum((value - mean) ** 2 for value, _ in values) / max(len(values) - 1, 1) / len(values))
        pooled[name] = [mean, spread if len(values) > 1 else values[0][1]]
    return pooled


def row(name, reference, spot):
    """Of a table: a quantity of the reference and of spot runs, each [value, error], and how far they are apart."""
    words = [f"{value:.4g} +- {error:.2g}" if math.isfinite(value) else "unknown" for value, error in (reference, spot)]
    known = math.isfinite(reference[0]) and math.isfinite(spot[0]) and reference[0] != 0
    return "| " + " | ".join([name, *words, f"{100 * (spot[0] / reference[0] - 1):+.1f} %" if known else ""]) + " |"
