# SPDX-License-Identifier: GPL-2.0-or-later
"""The mean flow in the core, and what is left of every grain's motion without it.

The field is smooth: fitted bins would take out part of the fluctuations too, and the more so the longer a grain
stays in one.
"""

from dataclasses import dataclass

import numpy as np

FIELD_MARGIN = 3.0  # d; grains that leave the core while they are followed still need the field
X_SCALE, Z_SCALE = 10.0, 30.0  # d; keep the terms near 1


@dataclass(frozen=True)
class Fluctuations:
    """Motion over the steps between snapshots, T steps of n grains; d.

    middle : (T, n, 3) middles of the steps
    residual : (T, n) displacement along x less the mean flow's; not a number outside the field
    drop : (T, n) downward displacement; not a number there
    """

    middle: np.ndarray
    residual: np.ndarray
    drop: np.ndarray


def take_out_mean_flow(tracks, core):
    """Fluctuations of ``tracks`` about the mean inclination of the streamlines times each grain's own drop.

    The inclination -u_x/v_z is fitted to all steps as a smooth function of (x, z). Grains at different y fall at
    different speeds and the flow swings in time, but streamlines keep their shape: a mean field of u_x, even one scaled
    by each step's amplitude, would leave the former in the fluctuations.
    """
    middle = (tracks.positions[1:] + tracks.positions[:-1]) / 2
    moved = np.diff(tracks.positions, axis=0)
    inside = core.contains(middle, margin=FIELD_MARGIN)
    drop = np.where(inside, -moved[..., 2], np.nan)
    residual = np.where(inside, moved[..., 0], np.nan)
    terms = _inclination_terms(middle[inside][:, 0], middle[inside][:, 2]) * drop[inside]
    coefficients = np.linalg.solve(terms @ terms.T, terms @ residual[inside])
    residual[inside] -= coefficients @ terms
    return Fluctuations(middle, residual, drop)


def _inclination_terms(x, z):
    """(12, n) terms x^p z^-q, p = 0 ... 3 and q = 1, 2, 3; a free walk of spots inclines streamlines by -x/(2 z)."""
    return np.stack([(x / X_SCALE)**p * (Z_SCALE / z)**q for p in range(4) for q in (1, 2, 3)])
