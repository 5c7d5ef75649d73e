#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Change one choice of the spot model at a time, and say what that does to its distance from DEM."""

import argparse
import math
import os
import sys

from spot_analysis.base.interpreter import require_packages

require_packages("numpy", "scipy", "matplotlib", "zstandard")

import numpy as np  # noqa: E402  (only after the check above)

from spot_analysis.base.progress import counted  # noqa: E402
from spot_analysis.commands import command_line, deck_run  # noqa: E402
from spot_analysis.report import comparison  # noqa: E402
from spot_analysis.statistics import (bond_angles, bond_order, counts, front, packing, particle_diffusion,  # noqa: E402
                                      profile_width, radial_distribution, run_statistics, thickness, velocity_correlation)
from spot_analysis.statistics.interval import choose_interval, common_times  # noqa: E402
from spot_analysis.statistics.interval_view import IntervalView  # noqa: E402

FOLDER = os.path.dirname(os.path.abspath(__file__))
MEASURED = (velocity_correlation, particle_diffusion, bond_angles, bond_order, thickness)
CONCEPTS = (counts, front, profile_width, packing, radial_distribution, *MEASURED)
D, TAU = 0.003, (0.003 / 9.81)**0.5  # m and s, of examples/silo/in.silo_spot
# name -> variables of the deck; "options" are added to the deck's own
CHOICES = {
    "the deck": {},
    **{f"side buffer {side} d": {"options": f"buffer {side * D} {2 * D}"} for side in (0, 0.5, 1)},
    **{f"base buffer {base} d": {"options": f"buffer {0.25 * D} {base * D}"} for base in (0, 1, 2.5)},
    "uniform spots": {"profile": "uniform", "radius": f"{2.6 * D}"},
    "R_s -25 %": {"radius": f"{2.65 * D}", "volume": "33.4"},
    "R_s +25 %": {"radius": f"{4.41 * D}", "volume": "147"},
    "persistence 0.8": {"options": "persistence 0.8"},
    "v_s (c / c_0)^2": {"dilation": "0.03", "speed": f"{2.5 * D / TAU}"},
    "w 2.5e-3": {"influence": "2.5e-3"},
    "w 6e-3": {"influence": "6e-3"},
    "v_s 8": {"speed": f"{8.0 * D / TAU}"},
    "b_s 1.35 d": {"diffusion": f"{1.35 * D}"},
    **{f"dz {dz} d": {"options": f"dz {dz * D}"} for dz in (0.025, 0.1, 0.4, 1.6)},
    "alpha 0.6": {"options": "alpha 0.6"},
    "alpha 1.0": {"options": "alpha 1.0"},
    "no momentum": {"options": "momentum 0"},
    "no contact overlap": {"options": "contact 0 relax tol 0.0025 momentum 0.7"},
    "tolerance 0.0012": {"options": "relax tol 0.0012"},
    "tolerance 0.0025": {"options": "relax tol 0.0025"},
    "tolerance 0.001, no momentum": {"options": "relax tol 0.001 momentum 0"},
    "spots of constant w": {"volume": "0", "critical": "0", "dilatancy": "0", "full_strain": "0"},
    # Whole fractions of the deck's timestep, 0.5 tau; its own window is 0.1 tau.
    **{f"window {window} tau": {"options": f"window {window * TAU}"} for window in (0.0025, 0.01, 0.02, 0.05, 0.25, 0.5)},
    **{f"order of time, dz {dz} d": {"options": f"accuracy exact dz {dz * D}"} for dz in (0.4, 0.8, 1.2)},
    "accuracy exact": {"options": "accuracy exact"},
}
QUANTITIES = {  # name in the comparison -> heading and factor
    "outflow": ("outflow (1/tau)", 1), **{f"flux_{z}d_over_outflow": (f"flux {z} d", 1) for z in counts.FLUX_HEIGHTS},
    "density_drop": ("drop", 1),
    "arrival_30d": ("t 30 d", 1), "arrival_60d": ("t 60 d", 1), "arrival_90d": ("t 90 d", 1),
    "variance_slope": ("slope (d)", 1),
    **{f"profile_variance_{z}d": (f"var {z} d (d^2)", 1) for z in profile_width.MOMENTS},
    "particle_diffusion": ("1e3 b_p (d)", 1e3), "correlation_length": ("beta (d)", 1),
    "correlation_rms": ("C rms", 1), "rdf_l2_ratio": ("g(r)", 1), "g3_l2_ratio": ("g3", 1), "contacts_per_grain": ("contacts", 1),
    "packing_fraction": ("fraction", 1), "badness_ratio": ("B/B_DEM", 1), "largest_overlap": ("overlap (d)", 1),
    "crystal_share": ("crystal", 1), "speed_wall_over_middle": ("v wall", 1),
}


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("dem", metavar="DEM", help="statistics of measure.py")
    parser.add_argument("-o", "--output", required=True, metavar="FOLDER", help="keeps statistics of every run; those there are "
                        "are not made again")
    parser.add_argument("--lmp", default=os.path.join(FOLDER, os.pardir, "build", "bin", "lmp"), metavar="COMMAND")
    parser.add_argument("--deck", default=os.path.join(FOLDER, os.pardir, "examples", "silo", "in.silo_spot"), metavar="FILE")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3], metavar="N")
    parser.add_argument("--only", nargs="+", choices=CHOICES, default=list(CHOICES), metavar="CHOICE")
    parser.add_argument("--parameters", metavar="FILE", help="of calibrate.py, in place of the deck's own")
    parser.add_argument("--time", type=float, metavar="TAU", help="how long to drain (default: the deck's)")
    parser.add_argument("--dumps", action="store_true", help="keep the dumps, too")
    return parser.parse_args()


def run_choice(options, choice, seed):
    """Statistics of a run of the deck, kept in the output folder; the dumps are not."""
    name = f"{choice.replace(' ', '_').replace('%', 'percent')}.{seed}"
    variables = {"seed": str(seed), **CHOICES[choice], "options": f"accuracy normal {CHOICES[choice].get('options', '')}"}
    if options.time:
        variables["time"] = str(options.time * TAU)
    if options.parameters:
        variables["parameters"] = os.path.abspath(options.parameters)
    return deck_run.kept(os.path.join(options.output, f"{name}.npz"), deck_run.settings_of(options.deck, variables), choice,
                         lambda dumps: deck_run.run_deck(options.lmp, options.deck, variables, dumps, choice), MEASURED,
                         keep_dumps=options.dumps)


def rows(dem, spot, start=None, end=None):
    """The comparison's rows of QUANTITIES from ``start`` to ``end`` (tau), by default over the steady part."""
    common = common_times(dem, spot)
    interval = choose_interval(dem.times[common[0]], start, end)
    found = comparison.compare(*(IntervalView(run, place, interval) for run, place in zip((dem, spot), common)),
                               sections={"": CONCEPTS})
    return [row for row in found if row.name in QUANTITIES]


def numbers(dem, spot, start=None, end=None):
    """name -> (DEM, spot) of these rows."""
    return {row.name: (row.dem, row.spot) for row in rows(dem, spot, start, end)}


def text(values, factor):
    """Mean and standard deviation over seeds, this to one digit and the mean as far."""
    known = [value * factor for value in values if value is not None]
    if not known:
        return "-"
    spread = np.std(known, ddof=1) if len(known) > 1 else 0
    if spread == 0:
        return f"{np.mean(known):.3g}"
    digits = max(0, -math.floor(math.log10(spread)))
    return f"{np.mean(known):.{digits}f} +- {spread:.{digits}f}"


def main():
    options = parse_arguments()
    os.makedirs(options.output, exist_ok=True)
    dem = run_statistics.load(options.dem)
    headings = [heading for heading, _ in QUANTITIES.values()]
    tasks = [(choice, seed) for choice in options.only for seed in options.seeds]
    runs = counted((run_choice(options, *task) for task in tasks), len(tasks), "runs")
    for number, choice in enumerate(options.only):
        found = [numbers(dem, next(runs)) for _ in options.seeds]
        if number == 0:
            print("| | " + " | ".join(headings) + " |\n" + "|---" * (len(headings) + 1) + "|")
            print("| DEM | " + " | ".join(text([found[0][name][0]], factor) for name, (_, factor) in QUANTITIES.items()) + " |")
        print(f"| {choice} | " + " | ".join(text([one[name][1] for one in found], factor)
                                            for name, (_, factor) in QUANTITIES.items()) + " |")
        sys.stdout.flush()


if __name__ == "__main__":
    command_line.run(main)
