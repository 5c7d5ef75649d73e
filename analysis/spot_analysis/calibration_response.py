# SPDX-License-Identifier: GPL-2.0-or-later
"""What a spot run shows against what was put into it, so that calibration can take the difference out.

    R_s shown = R_s + radius            b_s shown = b_s * diffusion         v_s shown = v_s * speed
    b_p = share * w b_s + particle_diffusion                                F = outflow * nu_s w <N>

share: 2006 has b_p = w b_s. It holds if a step moves the grains around its start. With influence taken at the middle of the
step, as 2006 says, steps that enter a grain's sphere and those that leave it undo each other in part: walks laid over a
grain give 0.69 to 0.72 with dz of 0.1 and 0.2 d, 0.76 to 0.80 with 0.8 d, for R_s of 2.2 to 3 d and b_s of 1 to 1.5 d.

particle_diffusion, radius: relaxation pushes grains about, and pushes on through their neighbours. What it adds depends on
the driver, and grows where w is small, so that below 2e-3 b_p hardly tells w. Runs of fix spot on the packing of
examples/silo, in d, 40-90 tau, with "accuracy normal" (dz = 0.8 d, relax tol 0.003, alpha 0.8, momentum 0.6) and a fixed
volume, outflow against nu_s w N:

    R_s    w        b_s   N     seed   R_s shown        b_s           b_p                added     v_s            outflow
    2.6    2.5e-3   1.25  77    1      2.68 +- 0.08     1.21 +- 0.02  (4.00 +- 0.07)e-3  1.59e-3   3.21 +- 0.04   0.951
    2.6    2.5e-3   1.25  77    2      2.78 +- 0.07     1.22 +- 0.02  (4.16 +- 0.09)e-3  1.75e-3   3.21 +- 0.01   0.961
    2.6    2.5e-3   1.25  77    3      2.80 +- 0.07     1.23 +- 0.02  (4.09 +- 0.11)e-3  1.68e-3   3.15 +- 0.04   0.959
    2.2    3.5e-3   1.0   47.5  1      2.43 +- 0.06     0.97 +- 0.01  (4.03 +- 0.14)e-3  1.34e-3   3.21 +- 0.02   0.970
    2.6    1.5e-3   1.25  77    1      2.84 +- 0.06     1.20 +- 0.02  (3.51 +- 0.14)e-3  2.07e-3   3.17 +- 0.02   0.961
    2.63   1.61e-3  1.57  79.5  1      2.80 +- 0.08     1.53 +- 0.02  (3.81 +- 0.16)e-3  1.87e-3   3.17 +- 0.02   0.959
    2.4    1.5e-3   1.25  61.5  2      2.56 +- 0.05     1.21 +- 0.02  (3.28 +- 0.10)e-3  1.83e-3   3.13 +- 0.01   0.964
    2.4    2.0e-3   1.4   61.5  1      2.65 +- 0.06     1.35 +- 0.02  (3.81 +- 0.11)e-3  1.65e-3   2.81 +- 0.01   0.970

Mean and scatter of these eight, the last with v_s = 2.8 d/tau and the others with 3.2 d/tau, are STORED as "windowed".
"time_ordered" (relax every 1, dz = 0.2 d, constant w) is from one run, 40-100 tau: R_s 2.91 +- 0.08, b_p (4.99 +- 0.19)e-3
for R_s = 2.6 d, w = 2.5e-3, b_s = 1.25 d.
"""

import numpy as np

from .bootstrap import RESAMPLES
from .calibration_estimate import Estimate

# (value, standard error)
FINE_SHARE, COARSE_SHARE = (0.70, 0.02), (0.77, 0.02)  # dz of 0.1 to 0.2 d, of 0.8 d
STORED = {
    "2006": {"stretch": (1.0, 0.0), "radius": (0.0, 0.0), "diffusion": (1.0, 0.0), "share": (1.0, 0.0), "particle_diffusion": (0.0, 0.0),
             "speed": (1.0, 0.0), "outflow": (1.0, 0.0)},
    "unrelaxed": {"stretch": (1.0, 0.0), "radius": (0.0, 0.0), "diffusion": (1.0, 0.0), "share": FINE_SHARE, "particle_diffusion": (0.0, 0.0),
                  "speed": (1.0, 0.0), "outflow": (1.0, 0.0)},
    "windowed": {"radius": (0.19, 0.055), "diffusion": (0.970, 0.008), "share": COARSE_SHARE,
                 "particle_diffusion": (1.72e-3, 0.22e-3), "speed": (0.995, 0.01), "outflow": (0.962, 0.006)},
    "time_ordered": {"stretch": (1.0, 0.0), "radius": (0.31, 0.08), "diffusion": (1.0, 0.01), "share": FINE_SHARE,
                     "particle_diffusion": (2.8e-3, 0.3e-3), "speed": (1.03, 0.02), "outflow": (0.90, 0.01)},
}
PROFILES = {"windowed": "parabolic"}  # of the spots; those of the others are uniform, as those of 2006
NAMES = tuple(STORED["2006"])


def stored_response(driver):
    """name -> Estimate for one of the keys of STORED; its scatter is independent of every measurement."""
    rng = np.random.default_rng(2010)
    return {name: Estimate(np.array(value), value + error * rng.normal(size=RESAMPLES))
            for name, (value, error) in STORED[driver].items()}
