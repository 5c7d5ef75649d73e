# SPDX-License-Identifier: GPL-2.0-or-later
"""The pictures of the report in their order: section -> name -> function and caption."""

import os

from matplotlib import pyplot as plt

from ..statistics.bonds import BOND_CUTOFF
from ..statistics.front_layer import LAYER_HEIGHT
from ..statistics.mean_flow import HALF_WIDTH, WALL_LAYER
from ..statistics.mixing import LAYER
from ..statistics.stagnation import SHARE
from ..statistics.velocity_correlation import BOTTOM, TOP
from . import plots_counts, plots_flow, plots_history, plots_silo, plots_structure

SECTIONS = {
    "The figures of 2006": {
        "silos": (plots_silo.silos, "The layer of grains at the front wall, or around y = 0 in a silo that repeats along y, coloured by the height it started at "
                  f"(bands of {LAYER_HEIGHT:g} d)."),
        "velocity_profiles": (plots_flow.velocity_profiles, "Downward velocity across x, from displacements over 2 tau, "
                              "mean over the interval, and Gaussian fits."),
        "profile_variance": (plots_flow.profile_variance, "Variance of the Gaussian fits against height, with lines "
                             "fitted over the shaded heights: slope 2 b_s for free spots."),
        "velocity_correlation": (plots_flow.correlation, f"C(r) of x-velocities about the mean flow, |x| < {HALF_WIDTH:g} d, "
                                 f"{BOTTOM:g} d < z < {TOP:g} d, more than {WALL_LAYER:g} d from the walls in y, and "
                                 "alpha exp(-r/beta) fitted over 1-6 d."),
        "particle_diffusion": (plots_flow.diffusion, "Variance of x about the mean flow against the height that grains "
                               "dropped; the slope over 1-5 d is 2 b_p."),
        "density_drop": (plots_counts.density_drop, "Grains in the slab in which 2006 measures the density drop."),
        "radial_distribution": (plots_structure.radial, "g(r) in the structure region, corrected for the slab."),
        "bond_angles": (plots_structure.angles, f"g3: angles between bonds (pairs closer than {BOND_CUTOFF:g} d) there."),
        "drained_grains": (plots_counts.drained_grains, "Grains left above z = 0, and the outflow. Shaded: the interval "
                           "compared."),
        "fluxes": (plots_counts.fluxes, "Flux through four heights. In steady flow each equals the outflow."),
        "long_times": (plots_structure.long_times, "g(r) at successive times of each run, where 2006 sees peaks at "
                       "sqrt(3) d and 2 d grow, and the share of crystal-like grains."),
    },
    "Through the run": {
        "through_the_run": (plots_history.through_the_run, "Packing fraction, crystal-like grains and g(r) around sqrt(3) d in the "
                            "structure region, and the angle of the free surface, from the start to the end of the run."),
    },
    "The figures of 2010": {
        "surface": (plots_structure.surface, "Free surface at the end of the interval, highest grain within 1.25 d of |x|, "
                    "and the angle of the straight line through it."),
        "across_thickness": (plots_structure.across_thickness, "Packing fraction and velocity across the thickness."),
        "packing_quality": (plots_structure.packing_quality, "Packing fraction, contacts a grain and badness in the "
                            "structure region."),
        "local_packing": (plots_structure.local_packing, "Packing fraction of Voronoi cells, mean over the interval."),
    },
    "For users of a silo": {
        "stagnant_zone": (plots_flow.stagnant_zone, f"Outside of this line grains move slower than {100 * SHARE:g} % of those "
                          "on the axis at the same height."),
        "residence_times": (plots_flow.residence_times, "How long the grains that left in the interval took from a level."),
        "layers": (plots_flow.layers, "Starting heights of all drained grains, and the share of neighbours from different "
                   f"layers, {LAYER:g} d thick at the start."),
    },
}
WIDE = {"through_the_run", "velocity_profiles", "drained_grains", "fluxes", "long_times", "radial_distribution", "surface", "across_thickness",
        "packing_quality", "local_packing", "residence_times", "layers"}
FIGURES = {name: figure for section in SECTIONS.values() for name, figure in section.items()}


def draw_pictures(folder, views, progress):
    """Draw every figure into ``folder``; returns name -> path of those that could be drawn."""
    paths = {}
    for number, (name, (draw, _)) in enumerate(FIGURES.items()):
        progress(f"drawing {name}", number / len(FIGURES))
        figure = draw(views)
        if figure is not None:
            paths[name] = os.path.join(folder, f"{name}.png")
            figure.savefig(paths[name], dpi=130)
            plt.close(figure)
    return paths
