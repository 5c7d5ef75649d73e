# SPDX-License-Identifier: GPL-2.0-or-later
"""b_p from the variance of the grains' sideways displacement against the distance they have dropped."""

from dataclasses import dataclass

import numpy as np

from .calibration_estimate import CalibrationError, Estimate, combine, estimate
from .fits import fit_line

DROPS = (1.0, 5.0)  # d; below, grains rattle in their cages


@dataclass(frozen=True)
class Diffusion:
    """Var(dx) against the drop, mean flow taken out.

    drop : (k,) d; variance : Estimate (k,) d^2; fitted : (k,) bool, those within DROPS
    line : Estimate (2,) slope and intercept
    length : Estimate, b_p = slope / 2, d
    """

    drop: np.ndarray
    variance: Estimate
    fitted: np.ndarray
    line: Estimate
    length: Estimate


def lagged_sums(fluctuations, core, lags):
    """For each step and each lag of 0 ... lags - 1 steps: products of a grain's residuals, drops and number of grains.

    Grains of the core at the first step count as long as they can be followed. Returns (T, lags, 3); 0 where the later
    step is past the last.
    """
    steps = len(fluctuations.residual)
    sums = np.zeros((steps, lags, 3))
    for step in range(steps):
        grains = core.contains(fluctuations.middle[step])
        residual, drop = fluctuations.residual[step, grains], fluctuations.drop[step, grains]
        for lag in range(min(lags, steps - step)):
            later = fluctuations.residual[step + lag, grains]
            known = np.isfinite(later)
            sums[step, lag] = (residual[known] * later[known]).sum(), drop[known].sum(), known.sum()
    return sums


def variance_of_sums(sums):
    """Var(dx) after 1 ... lags steps, (..., lags), and the mean drop a step, (...), from ``lagged_sums`` added up.

    Var over m steps = m c_0 + 2 sum_k (m - k) c_k with the autocovariances c_k of the steps. Every product counts at its
    own time, so paths that overlap do not make blocks depend on each other.
    """
    lags = sums.shape[-2]
    with np.errstate(invalid="ignore", divide="ignore"):  # a resample may hold none of the longest lag
        covariance = sums[..., 0] / sums[..., 2]
    steps, lag = np.arange(1, lags + 1)[:, None], np.arange(lags)
    times_counted = np.where(lag < steps, (steps - lag) * np.where(lag == 0, 1, 2), 0)
    return covariance @ times_counted.T, sums[..., 0, 1] / sums[..., 0, 2]


def measure_diffusion(tracks, fluctuations, core):
    """Diffusion of the core's grains; raises CalibrationError where they do not drop far enough, or do not diffuse."""
    here = core.contains(fluctuations.middle)
    drop_a_step = np.nanmean(fluctuations.drop[here]) if here.any() else 0
    steps = len(fluctuations.residual)
    lags = int(np.ceil(DROPS[1] / drop_a_step)) if drop_a_step > 0 else steps + 1
    if lags > steps * 2 / 3:
        raise CalibrationError(f"grains of the core drop by {max(drop_a_step, 0) * steps:.2g} d from {tracks.span[0]:g} to "
                               f"{tracks.span[1]:g} tau: b_p needs {1.5 * DROPS[1]:g} d, so more snapshots or more flow")
    return fit_diffusion(tracks.step_times, lagged_sums(fluctuations, core, lags), tracks.span)


def fit_diffusion(times, sums, span):
    """Diffusion from ``lagged_sums``, (T, lags, 3)."""
    lags = sums.shape[1]

    def statistic(flat):
        variance, drop = variance_of_sums(flat.reshape(*flat.shape[:-1], lags, 3))
        return np.concatenate([variance, drop[..., None]], axis=-1)

    both = estimate(times, sums.reshape(len(sums), -1), span, statistic)
    drop = np.arange(1, lags + 1) * both.value[-1]
    fitted = (drop > DROPS[0] - 1e-9) & (drop < DROPS[1] + 1e-9)
    if fitted.sum() < 3:
        raise CalibrationError(f"grains of the core drop by {both.value[-1]:.2g} d between snapshots: too far for the slope "
                               f"of Var(dx) over drops of {DROPS[0]:g} to {DROPS[1]:g} d")

    def line(flat):
        values = statistic(flat)
        slope, intercept = fit_line(np.arange(1, lags + 1)[fitted], values[..., :-1][..., fitted])
        return np.stack([slope / values[..., -1], intercept], axis=-1)

    lines = estimate(times, sums.reshape(len(sums), -1), span, line)
    slope = lines[0]
    if not slope.is_determined():
        raise CalibrationError(f"Var(dx) does not grow with the drop (slope {slope.value:.2g} +- {slope.error:.2g} d): no b_p")
    return Diffusion(drop, Estimate(both.value[:-1], both.replicates[:, :-1]), fitted, lines,
                     combine(lambda value: value / 2, slope))
