# SPDX-License-Identifier: GPL-2.0-or-later
"""b_p from ``particle_diffusion``, with replicates of its fit."""

from dataclasses import dataclass

import numpy as np

from ..statistics import particle_diffusion
from ..statistics.fits import fit_line
from .estimate import CalibrationError, Estimate, combine
from .view import estimate_pairs, require_cover


@dataclass(frozen=True)
class Diffusion:
    """variance : Estimate (D,), Var(x) about the mean flow after particle_diffusion.DROPS, d^2
    line : Estimate (2,), slope and intercept; length : Estimate, b_p = slope / 2, d
    """

    variance: Estimate
    line: Estimate
    length: Estimate


def measure_diffusion(view):
    """Diffusion of the core's grains; raises CalibrationError where they do not drop far enough, or do not diffuse."""
    part = view.run.measured[particle_diffusion.NAME]
    require_cover(view, part.start, part.end, particle_diffusion.TOP)
    rows = view.pair_rows(part.start, part.end)
    drop = part.fallen[rows].sum() / part.grains[rows, 0].sum()
    furthest, steps = particle_diffusion.DROPS[-1], len(rows)
    if not drop * min(steps * 2 / 3, particle_diffusion.LAGS) >= furthest:
        raise CalibrationError(f"grains of the core drop by {max(drop, 0) * steps:.2g} d from {view.interval.start:g} to "
                               f"{view.interval.end:g} tau: b_p needs {1.5 * furthest:g} d, and {furthest:g} d within "
                               f"{particle_diffusion.LAGS} steps, so more snapshots or more flow")
    variance = estimate_pairs(view, part.start, part.end, particle_diffusion.columns(part, view.interval.end),
                              particle_diffusion.variances)
    return fit_diffusion(variance)


def fit_diffusion(variance):
    """Diffusion from its ``variance``."""
    line = combine(lambda values: np.stack(fit_line(particle_diffusion.DROPS, values), axis=-1), variance)
    slope = line[0]
    if not slope.is_determined():
        raise CalibrationError(f"Var(x) does not grow with the drop (slope {slope.value:.2g} +- {slope.error:.2g} d): no b_p")
    return Diffusion(variance, line, combine(lambda value: value / 2, slope))
