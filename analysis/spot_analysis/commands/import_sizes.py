# SPDX-License-Identifier: GPL-2.0-or-later
"""The diameters of a packing that is imported."""

import numpy as np

from ..base.errors import AnalysisError

EQUAL, NEARLY_EQUAL = 1e-6, 0.01  # spreads of diameters: of equal grains, and what --equal-sizes makes equal
WIDEST = 2  # diameters of the smallest grain, that fix spot allows


def diameters_of(options, grains, scale):
    """(n,) in the deck's unit; raises AnalysisError where they differ too much."""
    n = len(grains.positions)
    if options.diameter:
        return np.full(n, options.diameter)
    if grains.diameters is None:
        raise AnalysisError(f"{options.packing}: no diameters or radii in it: give --diameter")
    low, mean, high = (float(function(grains.diameters)) for function in (np.min, np.mean, np.max))
    spread = max(high - mean, mean - low) / mean
    if spread <= EQUAL:
        return np.full(n, mean * scale)
    sizes = f"diameters are {low * scale:.6g} to {high * scale:.6g}, up to {100 * spread:.2g} % off their mean"
    if options.equal_sizes:
        if spread > NEARLY_EQUAL:
            raise AnalysisError(f"{options.packing}: {sizes}; --equal-sizes makes equal what is within 1 %: leave it out")
        print(f"sizes: {sizes}; all have {mean * scale:.6g} now")
        return np.full(n, mean * scale)
    if high > WIDEST * low:
        raise AnalysisError(f"{options.packing}: {sizes}; no grain may be more than {WIDEST} times as wide as another")
    hint = ", though --equal-sizes would drain faster" if spread <= NEARLY_EQUAL else ""
    print(f"sizes: {sizes}; they stay as they are{hint}")
    return grains.diameters * scale


def mean_diameter(diameters):
    """Of a grain of mean volume: what fix spot calls d."""
    return float(np.cbrt(np.mean(diameters**3)))
