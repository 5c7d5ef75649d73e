# SPDX-License-Identifier: GPL-2.0-or-later
"""What goes out and what is missing: outflow, whether it is steady, and the drop of density; d and tau."""

import numpy as np

from ..statistics.counts import SLAB, slab_counts
from ..statistics.packing import fractions
from ..statistics.neighbours import RDF_RANGE
from .estimate import CalibrationError, combine
from .view import estimate_snapshots, estimate_steps

UNSTEADY = 0.15  # share of the outflow by which flow may drift, or differ at the slab, and still count as steady


def measure_outflow(view):
    """F, grains a tau through z = 0, an Estimate; raises CalibrationError where there is none or it is not steady."""
    outflow = _rate(view, 0.0)
    start, end = view.interval.span
    if not outflow.is_determined():
        raise CalibrationError(f"no steady flow: {outflow.value:.2g} +- {outflow.error:.2g} grains a tau leave between "
                               f"{start:g} and {end:g} tau")
    _require_steady(view, outflow)
    return outflow


def _require_steady(view, outflow):
    """Outflow must not drift, and what flows in through the slab's bottom must be what flows out."""
    middle, crossed = np.mean(view.interval.span), view.crossings(0.0)
    times = view.run.times[view.snapshots]
    late, durations = (times[1:] + times[:-1]) / 2 > middle, np.diff(times)
    early_rate, late_rate = (crossed[part].sum() / durations[part].sum() for part in (~late, late))
    drift = late_rate - early_rate
    if abs(drift) > max(UNSTEADY * outflow.value, 4 * outflow.error):
        raise CalibrationError(f"no steady flow: {early_rate:.3g} grains a tau leave before {middle:g} tau, "
                               f"{late_rate:.3g} after; choose a later interval with --from")
    above = _rate(view, SLAB[0])
    difference = combine(lambda one, other: one - other, above, outflow)
    if abs(difference.value) > max(UNSTEADY * outflow.value, 3 * difference.error):
        raise CalibrationError(f"no steady flow: {above.value:.3g} grains a tau pass z = {SLAB[0]} d, but "
                               f"{outflow.value:.3g} leave; choose a later interval with --from")


def _rate(view, level):
    """Grains a tau that pass ``level``, an Estimate."""
    durations = np.diff(view.run.times[view.snapshots])
    return estimate_steps(view, np.column_stack([view.crossings(level), durations]),
                          lambda sums: sums[..., 0] / sums[..., 1])


def measure_drop(view):
    """Grains that the slab has lost since the start, an Estimate; raises CalibrationError where it lost none."""
    run = view.run
    if not run.count_above(SLAB[1])[view.snapshots[-1]]:
        raise CalibrationError(f"the packing ends within the slab of {SLAB[0]} to {SLAB[1]} d whose density drop gives v_s")
    counts = slab_counts(run)
    drop = estimate_snapshots(view, np.column_stack([counts, np.ones(len(counts))]),
                              lambda sums: counts[0] - sums[..., 0] / sums[..., 1])
    if not drop.is_determined():
        raise CalibrationError(f"density does not drop: {counts[0]} grains in {SLAB[0]} d < z < {SLAB[1]} d at rest, "
                               f"{counts[0] - drop.value:.0f} +- {drop.error:.0f} in flow; no v_s")
    return drop


def measure_fraction(view):
    """Packing fraction of the structure region in flow, an Estimate."""
    fraction = fractions(view.run)
    if not np.isfinite(fraction[view.snapshots]).all():
        raise CalibrationError(f"the packing is too low: it ends within the structure region or {RDF_RANGE:g} d above")
    return estimate_snapshots(view, np.column_stack([fraction, np.ones(len(fraction))]),
                              lambda sums: sums[..., 0] / sums[..., 1])
