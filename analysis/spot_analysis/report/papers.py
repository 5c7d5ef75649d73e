# SPDX-License-Identifier: GPL-2.0-or-later
"""What the papers report, to stand beside the numbers of the comparison."""

# name -> value of DEM, value of the spot model, source; tau = 17.49 ms. None where the paper gives none.
PAPERS = {
    "outflow": (77.0, None, "2006"),
    "slab_count": (8850, None, "2006"),
    "density_drop": (550, None, "2006"),
    "density_drop_fraction": (0.0585, None, "2006"),
    "profile_variance_slope": (2.28, None, "2006"),
    "variance_slope": (2.28, None, "2006"),
    "variance_intercept": (1.60, None, "2006"),
    "particle_diffusion": (2.86e-3, 2.73e-3, "2006"),
    "correlation_length": (1.87, None, "2006"),
    "rdf_first_minimum": (1.38, None, "2006"),
    "crystal_share": (None, 0.02, "2006, at 8-16 s"),
    "badness_ratio": (1, 0.30, "2010, relaxed after each move"),
}
