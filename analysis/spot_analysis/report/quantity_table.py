# SPDX-License-Identifier: GPL-2.0-or-later
"""Quantities, name -> [value, standard error], of one run as a table, or of several side by side with a reference."""

import math

UNKNOWN = [math.nan, math.nan]


def pooled(runs):
    """Mean over runs, with the standard error over them where there are several."""
    pooled = {}
    for name in dict.fromkeys(name for run in runs for name in run):
        values = [run.get(name, UNKNOWN) for run in runs]
        mean = sum(value for value, _ in values) / len(values)
        spread = math.sqrt(sum((value - mean) ** 2 for value, _ in values) / max(len(values) - 1, 1) / len(values))
        pooled[name] = [mean, spread if len(values) > 1 else values[0][1]]
    return pooled


def lines(interval, source, reference, spot, runs):
    """Of a table with a row for each quantity of either; what one of them lacks is unknown.

    interval : in words; source : name of the reference; spot : None where there is the reference alone; runs : how many
    it pools
    """
    heading = [interval, source, *([f"{runs} of spot", "difference"] if spot is not None else [])]
    yield "| " + " | ".join(heading) + " |"
    yield "|" + len(heading) * "---|"
    for name in {**reference, **(spot or {})}:
        one = reference.get(name, UNKNOWN)
        cells = [_words(one)] if spot is None else [_words(one), *_compared(one, spot.get(name, UNKNOWN))]
        yield "| " + " | ".join([name, *cells]) + " |"


def _words(quantity):
    value, error = quantity
    if not math.isfinite(value):
        return "unknown"
    return f"{value:.4g} +- {error:.2g}" if math.isfinite(error) else f"{value:.4g}"


def _compared(one, other):
    known = math.isfinite(one[0]) and math.isfinite(other[0]) and one[0] != 0
    return _words(other), f"{100 * (other[0] / one[0] - 1):+.1f} %" if known else ""
