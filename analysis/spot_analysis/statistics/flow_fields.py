# SPDX-License-Identifier: GPL-2.0-or-later
"""Mean fields of the flow in the plane of x and z, from wall to wall in y; lengths in d, times in tau.

They come from the sums of ``flow_sums``, as means over a Gaussian around a place.
"""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import gaussian_filter

SMOOTHING = (1.5, 2.0)  # d along x and z, of all fields
DILATION_SMOOTHING = (2.0, 3.0)  # d, of those from which gradients of the packing fraction are taken
SURFACE = 8  # d below the free surface that are left out
STILL = 1e-6  # d/tau, under which nothing counts as falling
BULK = 5  # d above the base and below the surface, between which the packing at rest is averaged


@dataclass(frozen=True)
class FlowFields:
    """Fields (X, Z) in x = 0.5, 1.5, ... and z = 0.5, 1.5, ... over one interval.

    u, v_x : downward velocity and that away from the axis, d/tau; u_x, u_z, v_xx, v_xz their gradients
    profile : u in bins, not smoothed, of which widths are taken
    s, s_x : shear per distance fallen |u_x| / u, 1/d, and ds/dx
    fraction : packing fraction, in bins, not smoothed
    dilation, dilation_gradient : c = 1 - phi / phi at rest, and dc/dx, 1/d
    loss : rate at which the packing loosens where it is, div v = -(d phi/dt + v grad phi) / phi, 1/tau
    strain : integral of |du/dx| dt over the grains' paths since the start; fallen : their descent since then, d
    top : index along z from which on the free surface is too near
    """

    u: np.ndarray
    v_x: np.ndarray
    profile: np.ndarray
    s: np.ndarray
    s_x: np.ndarray
    u_x: np.ndarray
    u_z: np.ndarray
    v_xx: np.ndarray
    v_xz: np.ndarray
    fraction: np.ndarray
    dilation: np.ndarray
    dilation_gradient: np.ndarray
    loss: np.ndarray
    strain: np.ndarray
    fallen: np.ndarray
    top: int


def top_of(counts):
    """Bins of z that lie SURFACE below the lowest place of the free surface; counts (2 X, Z)."""
    filled = gaussian_filter(counts, (2, 1), mode="nearest")
    enough = filled > 0.5 * np.median(filled[:, BULK:BULK + 25])
    highest = enough.shape[1] - np.argmax(enough[:, ::-1], axis=1)
    return int(np.where(enough.any(axis=1), highest, 0).min()) - SURFACE


def smooth(values, width=SMOOTHING):
    return gaussian_filter(values, width, mode="constant")


def at_rest(grains, heights, top):
    """Grains a bin of the packing at rest, (2 X, Z), without its scatter: a profile along x times a parabola along z."""
    bulk = (heights > BULK) & (heights < top)
    across, along = grains[:, bulk].mean(axis=1), grains[:, bulk].mean(axis=0)
    return across[:, None] * np.polyval(np.polyfit(heights[bulk], along / along.mean(), 2), heights)


def fields_of(sums, rest, fraction_of_grain, top):
    """FlowFields from sums over an interval.

    sums : name -> number or (2 X, Z), symmetric in x, or antisymmetric (v_x), as ``flow_sums`` names them
    rest : ``at_rest``; fraction_of_grain : what a grain adds to the packing fraction of a bin
    """
    def mean(name, over="moved", width=SMOOTHING):
        return smooth(sums[name], width) / np.maximum(smooth(sums[over], width), 1e-9)

    n = sums["snapshots"]
    grains, rest_near = sums["grains"] / n, np.maximum(smooth(rest, DILATION_SMOOTHING), 1e-9)
    near = np.maximum(smooth(grains, DILATION_SMOOTHING), 1e-9)
    spread = sums["tt"] - sums["t"]**2 / n
    growth = (sums["t grains"] - sums["t"] * grains) / spread if spread > 0 else np.zeros_like(grains)
    u, v_x = mean("u"), mean("v_x")
    u_x, u_z = np.gradient(u)
    v_xx, v_xz = np.gradient(v_x)
    n_x, n_z = np.gradient(near)
    c = 1 - near / rest_near
    s = np.abs(u_x) / np.maximum(u, STILL)
    whole = {"u": u, "profile": sums["u"] / np.maximum(sums["moved"], 1), "s": s, "s_x": np.gradient(smooth(s))[0],
             "v_x": v_x, "u_x": u_x, "u_z": u_z, "v_xx": v_xx, "v_xz": v_xz, "fraction": grains * fraction_of_grain,
             "dilation": c, "dilation_gradient": np.gradient(c)[0],
             "loss": -(smooth(growth, DILATION_SMOOTHING) + v_x * n_x - u * n_z) / near,
             "strain": mean("strain"), "fallen": mean("fallen")}
    return FlowFields(**{name: field[len(field) // 2:] for name, field in whole.items()}, top=top)
