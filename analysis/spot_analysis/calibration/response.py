# SPDX-License-Identifier: GPL-2.0-or-later
"""What a spot run shows against what was put into it, so that calibration can take the difference out.

    R_s shown = RADIUS + radius + radius_slope (R_s - RADIUS)     b_s shown = b_s * diffusion
    v_s shown = speed * v_s (c / dilation)^2, c being the share of the volume that is missing, or speed * v_s without dilation
    b_p = share * w b_s + particle_diffusion + diffusion_slope (R_s - RADIUS)

R_s is that of uniform spots with the same volume. 2006 has b_p = w b_s. It holds if a step moves the grains around its start.
With influence taken at the middle of the step, as 2006 says, steps that enter a grain's sphere and those that leave it undo
each other in part: walks laid over a grain give a share of 0.69 to 0.72 with dz of 0.1 and 0.2 d, for R_s of 2.2 to 3 d and
b_s of 1 to 1.5 d. Relaxation pushes grains about, on through their neighbours, and the more so the smaller w: so a fifth of
w b_s is all by which b_p follows w, and R_s matters as much. Runs of fix spot on the packing of examples/silo (parabolic spots
of a fixed volume, dilation 0.03, "accuracy normal"), in d and tau, 40-90 tau, speed and outflow over what the parameters say
(births did not follow what leaves; they do now, so the outflow needs no correction); analysis/one_factor.py made them:

    R_s    w        b_s   N     v_s   seed   R_s shown       b_s shown       b_p             speed            outflow
    2.6    2.5e-3   1.4   77    2.5   1      3.19 +- 0.10    1.42 +- 0.03    2.88e-3         1.30 +- 0.01     0.979
    2.6    2.5e-3   1.4   77    2.5   2      3.00 +- 0.09    1.40 +- 0.03    2.68e-3         1.28 +- 0.01     0.988
    2.6    2.5e-3   1.4   77    2.5   3      2.97 +- 0.09    1.43 +- 0.02    2.85e-3         1.29 +- 0.02     0.990
    1.95   2.5e-3   1.4   33.4  2.5   1      2.43 +- 0.05    1.38 +- 0.01    2.28e-3         1.29 +- 0.01     1.013
    1.95   2.5e-3   1.4   33.4  2.5   2      2.59 +- 0.10    1.42 +- 0.02    2.29e-3         1.28 +- 0.01     1.005
    3.25   2.5e-3   1.4   147   2.5   1      3.59 +- 0.19    1.44 +- 0.03    3.43e-3         1.31 +- 0.01     0.936
    3.25   2.5e-3   1.4   147   2.5   2      3.51 +- 0.09    1.48 +- 0.03    3.38e-3         1.26 +- 0.02     0.947
    2.6    1.5e-3   1.4   77    2.5   1      3.04 +- 0.06    1.45 +- 0.01    2.59e-3         1.31 +- 0.01     0.991
    2.6    6e-3     1.4   77    2.5   1      2.94 +- 0.12    1.35 +- 0.02    3.77e-3         1.32 +- 0.02     0.973
    2.6    6e-3     1.4   77    2.5   2      2.90 +- 0.05    1.42 +- 0.04    4.04e-3         1.29 +- 0.02     0.974
    2.6    2.5e-3   1.4   77    3.0   1      3.08 +- 0.11    1.42 +- 0.03    2.83e-3         1.35 +- 0.01     0.978

Straight lines through these, with the scatter about them (of R_s, whose values scatter within their own errors, somewhat less), are STORED as "windowed". The speed is more than 1, since c is not the same
all across the slab.
"time_ordered" (uniform spots, relax every 1, dz = 0.2 d, constant w) is from one run, 40-100 tau: R_s 2.91 +- 0.08, b_p
(4.99 +- 0.19)e-3 for R_s = 2.6 d, w = 2.5e-3, b_s = 1.25 d.
"""

import numpy as np

from ..statistics.bootstrap import RESAMPLES
from .estimate import Estimate

# (value, standard error)
FINE_SHARE = (0.70, 0.02)  # dz of 0.1 to 0.2 d
RADIUS = 2.6  # d
SLOPES = ("radius_slope", "diffusion_slope", "share", "dilation")  # what one run cannot tell
FREE = {"radius_slope": (1.0, 0.0), "diffusion_slope": (0.0, 0.0), "dilation": (0.0, 0.0)}  # shown as it is, whatever R_s and c
STORED = {
    "2006": {**FREE, "radius": (0.0, 0.0), "diffusion": (1.0, 0.0), "share": (1.0, 0.0), "particle_diffusion": (0.0, 0.0),
             "speed": (1.0, 0.0)},
    "unrelaxed": {**FREE, "radius": (0.0, 0.0), "diffusion": (1.0, 0.0), "share": FINE_SHARE, "particle_diffusion": (0.0, 0.0),
                  "speed": (1.0, 0.0)},
    "windowed": {"radius": (0.42, 0.05), "radius_slope": (0.80, 0.08), "diffusion": (1.015, 0.025), "share": (0.22, 0.03),
                 "particle_diffusion": (2.08e-3, 0.08e-3), "diffusion_slope": (0.86e-3, 0.08e-3), "dilation": (0.03, 0.0),
                 "speed": (1.30, 0.03)},
    "time_ordered": {**FREE, "radius": (0.31, 0.08), "diffusion": (1.0, 0.01), "share": FINE_SHARE,
                     "particle_diffusion": (2.8e-3, 0.3e-3), "speed": (1.03, 0.02)},
}
PROFILES = {"windowed": "parabolic"}  # of the spots; those of the others are uniform, as those of 2006
NAMES = tuple(STORED["2006"])


def stored_response(driver):
    """name -> Estimate for one of the keys of STORED; its scatter is independent of every measurement."""
    rng = np.random.default_rng(2010)
    return {name: Estimate(np.array(value), value + error * rng.normal(size=RESAMPLES))
            for name, (value, error) in STORED[driver].items()}
