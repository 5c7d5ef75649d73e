# SPDX-License-Identifier: GPL-2.0-or-later
"""What a spot run shows against what was put into it, so that calibration can take the difference out.

    R_s shown = RADIUS + radius + radius_slope (R_s - RADIUS)     b_s shown = b_s * diffusion
    v_s shown = speed * v_s (c / dilation)^2, c being the share of the volume that is missing, or speed * v_s without dilation
    b_p = share * w b_s + particle_diffusion + diffusion_slope (R_s - RADIUS)
    F = outflow * nu_s w <N>

R_s is that of uniform spots with the same volume. 2006 has b_p = w b_s. It holds if a step moves the grains around its start.
With influence taken at the middle of the step, as 2006 says, steps that enter a grain's sphere and those that leave it undo
each other in part: walks laid over a grain give a share of 0.69 to 0.72 with dz of 0.1 and 0.2 d, for R_s of 2.2 to 3 d and
b_s of 1 to 1.5 d. Relaxation pushes grains about, on through their neighbours, and the more so the smaller w: so a third of
w b_s is all by which b_p follows w, and R_s matters as much. Runs of fix spot on the packing of examples/silo (parabolic spots
of a fixed volume, "accuracy normal"), in d and tau, 40-90 tau, outflow against nu_s w N; analysis/one_factor.py made them:

    R_s    w        b_s   N     v_s   seed   R_s shown       b_s shown       b_p             v_s shown       outflow
    2.6    2.5e-3   1.35  77    3.0   1      2.98 +- 0.07    1.35 +- 0.03    3.02e-3         3.12 +- 0.04    0.977
    2.6    2.5e-3   1.35  77    3.0   2      3.04 +- 0.16    1.35 +- 0.03    3.02e-3         3.11 +- 0.02    0.987
    2.6    2.5e-3   1.35  77    3.0   3      3.02 +- 0.06    1.35 +- 0.02    3.10e-3         3.15 +- 0.06    0.993
    1.95   2.5e-3   1.35  33.4  3.0   1      2.64 +- 0.09    1.34 +- 0.02    2.48e-3         3.14 +- 0.01    1.009
    1.95   2.5e-3   1.35  33.4  3.0   2      2.50 +- 0.05    1.34 +- 0.02    2.45e-3         3.15 +- 0.02    1.000
    3.25   2.5e-3   1.35  147   3.0   1      3.62 +- 0.09    1.31 +- 0.04    3.57e-3         3.00 +- 0.04    0.954
    3.25   2.5e-3   1.35  147   3.0   2      3.82 +- 0.19    1.37 +- 0.02    3.38e-3         3.00 +- 0.04    0.961
    2.6    1.5e-3   1.35  77    3.0   1      2.95 +- 0.08    1.35 +- 0.02    2.58e-3         3.12 +- 0.02    0.994
    2.6    2.5e-3   1.35  77    3.65  1      2.93 +- 0.09    1.37 +- 0.03    3.30e-3         3.93 +- 0.06    0.977

Straight lines through these, and the scatter about them, are STORED as "windowed".
"time_ordered" (uniform spots, relax every 1, dz = 0.2 d, constant w) is from one run, 40-100 tau: R_s 2.91 +- 0.08, b_p
(4.99 +- 0.19)e-3 for R_s = 2.6 d, w = 2.5e-3, b_s = 1.25 d.
"""

import numpy as np

from .bootstrap import RESAMPLES
from .calibration_estimate import Estimate

# (value, standard error)
FINE_SHARE = (0.70, 0.02)  # dz of 0.1 to 0.2 d
RADIUS = 2.6  # d
SLOPES = ("radius_slope", "diffusion_slope", "share", "dilation")  # what one run cannot tell
FREE = {"radius_slope": (1.0, 0.0), "diffusion_slope": (0.0, 0.0), "dilation": (0.0, 0.0)}  # shown as it is, whatever R_s and c
STORED = {
    "2006": {**FREE, "radius": (0.0, 0.0), "diffusion": (1.0, 0.0), "share": (1.0, 0.0), "particle_diffusion": (0.0, 0.0),
             "speed": (1.0, 0.0), "outflow": (1.0, 0.0)},
    "unrelaxed": {**FREE, "radius": (0.0, 0.0), "diffusion": (1.0, 0.0), "share": FINE_SHARE, "particle_diffusion": (0.0, 0.0),
                  "speed": (1.0, 0.0), "outflow": (1.0, 0.0)},
    "windowed": {"radius": (0.41, 0.06), "radius_slope": (0.89, 0.08), "diffusion": (0.998, 0.014), "share": (0.33, 0.05),
                 "particle_diffusion": (1.93e-3, 0.12e-3), "diffusion_slope": (0.78e-3, 0.10e-3), "dilation": (0.03, 0.0),
                 "speed": (1.19, 0.03), "outflow": (0.984, 0.018)},
    "time_ordered": {**FREE, "radius": (0.31, 0.08), "diffusion": (1.0, 0.01), "share": FINE_SHARE,
                     "particle_diffusion": (2.8e-3, 0.3e-3), "speed": (1.03, 0.02), "outflow": (0.90, 0.01)},
}
PROFILES = {"windowed": "parabolic"}  # of the spots; those of the others are uniform, as those of 2006
NAMES = tuple(STORED["2006"])


def stored_response(driver):
    """name -> Estimate for one of the keys of STORED; its scatter is independent of every measurement."""
    rng = np.random.default_rng(2010)
    return {name: Estimate(np.array(value), value + error * rng.normal(size=RESAMPLES))
            for name, (value, error) in STORED[driver].items()}
