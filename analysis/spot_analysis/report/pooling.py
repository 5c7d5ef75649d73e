# SPDX-License-Identifier: GPL-2.0-or-later
"""One Value from those of several runs."""

import numpy as np

from ..statistics.value import Value


def pool_runs(values):
    """DEM's Value from several runs of the same silo: the mean, with an error of at least half of what they are apart."""
    known = [one for one in values if one.value is not None]
    if len(known) < 2:
        return known[0] if known else values[0]
    numbers = [one.value for one in known]
    errors = [one.error or 0 for one in known]
    error = max(np.sqrt(np.sum(np.square(errors))) / len(known), (max(numbers) - min(numbers)) / 2)
    return Value(known[0].unit, float(np.mean(numbers)), float(error))


def pool_seeds(values):
    """The spot model's Value: mean over seeds and its standard error from their spread, of one seed its own."""
    known = [one for one in values if one.value is not None]
    if len(known) < 2:
        return known[0] if known else values[0]
    numbers = [one.value for one in known]
    return Value(known[0].unit, float(np.mean(numbers)), float(np.std(numbers, ddof=1) / np.sqrt(len(numbers))))


def mean(values):
    """The mean of those that are known, without an error."""
    known = [one.value for one in values if one.value is not None]
    return Value(values[0].unit, float(np.mean(known))) if known else values[0]
