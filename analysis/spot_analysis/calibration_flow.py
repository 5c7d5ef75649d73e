# SPDX-License-Identifier: GPL-2.0-or-later
"""What goes out and what is missing: outflow, whether it is steady, and the drop of density; d and tau."""

import numpy as np

from .calibration_estimate import CalibrationError, combine, estimate
from .counts import SLAB

UNSTEADY = 0.15  # share of the outflow by which flow may drift, or differ at the slab, and still count as steady


def measure_outflow(tracks):
    """F, grains a tau through z = 0, an Estimate; raises CalibrationError where there is none or it is not steady."""
    crossed = _crossings(tracks, 0.0)
    durations = np.diff(tracks.times)
    outflow = _rate(tracks, crossed, durations)
    if not outflow.is_determined():
        raise CalibrationError(f"no steady flow: {outflow.value:.2g} +- {outflow.error:.2g} grains a tau leave between "
                               f"{tracks.span[0]:g} and {tracks.span[1]:g} tau")
    _require_steady(tracks, outflow)
    return outflow


def _require_steady(tracks, outflow):
    """Outflow must not drift, and what flows in through the slab's bottom must be what flows out."""
    middle = np.mean(tracks.span)
    late = tracks.step_times > middle
    crossed, durations = _crossings(tracks, 0.0), np.diff(tracks.times)
    early_rate, late_rate = (crossed[part].sum() / durations[part].sum() for part in (~late, late))
    drift = late_rate - early_rate
    if abs(drift) > max(UNSTEADY * outflow.value, 4 * outflow.error):
        raise CalibrationError(f"no steady flow: {early_rate:.3g} grains a tau leave before {middle:g} tau, "
                               f"{late_rate:.3g} after; choose a later interval with --from")
    above = _rate(tracks, _crossings(tracks, SLAB[0]), durations)
    difference = combine(lambda one, other: one - other, above, outflow)
    if abs(difference.value) > max(UNSTEADY * outflow.value, 3 * difference.error):
        raise CalibrationError(f"no steady flow: {above.value:.3g} grains a tau pass z = {SLAB[0]} d, but "
                               f"{outflow.value:.3g} leave; choose a later interval with --from")


def _crossings(tracks, level):
    """(T - 1,) grains that pass ``level`` between snapshots; those that left the dump are below."""
    with np.errstate(invalid="ignore"):
        return -np.diff((tracks.positions[..., 2] > level).sum(axis=1))


def _rate(tracks, crossed, durations):
    return estimate(tracks.step_times, np.column_stack([crossed, durations]), tracks.span,
                    lambda sums: sums[..., 0] / sums[..., 1])


def measure_drop(tracks):
    """Grains that the slab has lost since the start, an Estimate; raises CalibrationError where it lost none."""
    at_rest = int(_in_slab(tracks.initial[:, 2]))
    heights = tracks.positions[..., 2]
    highest = np.nanmax(heights[-1])
    if highest < SLAB[1]:
        raise CalibrationError(f"the packing ends at z = {highest:.0f} d, within the slab of {SLAB[0]} to {SLAB[1]} d whose "
                               "density drop gives v_s")
    with np.errstate(invalid="ignore"):
        counts = _in_slab(heights)
    drop = estimate(tracks.times, np.column_stack([counts, np.ones(len(counts))]), tracks.span,
                    lambda sums: at_rest - sums[..., 0] / sums[..., 1])
    if not drop.is_determined():
        raise CalibrationError(f"density does not drop: {at_rest} grains in {SLAB[0]} d < z < {SLAB[1]} d at rest, "
                               f"{at_rest - drop.value:.0f} +- {drop.error:.0f} in flow; no v_s")
    return drop


def _in_slab(heights):
    return ((heights > SLAB[0]) & (heights < SLAB[1])).sum(axis=-1)
