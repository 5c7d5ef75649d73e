#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Time the spot model against DEM (LIGGGHTS and LAMMPS) in the steady drainage of the silo of examples/silo, in one session.

Processor time and wall time per simulated second of flow; start-up, warm-up and snapshots are left out. See README.md.
"""

import gzip
import math
import os
import shutil
import statistics
import sys

from measuring import (BENCHMARKS, ROOT, TAU, WARM_UP, BenchmarkError, Reference, command_line, cost_of, deck_variables,
                       follow, number, parallel, program, provenance, quality, run, run_spot, spot_deck, spread,
                       warn_of_others, write_json)

DEM_DECKS = ROOT / "liggghts-inputs" / "silo"
PAPER_STEP = 1e-4  # tau


def ratio(dem, spot):
    """Of the medians; and its extremes, one program at its fastest, the other at its slowest."""
    return {"median": statistics.median(dem) / statistics.median(spot), "min": min(dem) / max(spot),
            "max": max(dem) / min(spot)}


# --- The programs -----------------------------------------------------------------------------------------------------

def dem_cost(output, section, timestep, repeats):
    """Of the last ``repeats`` stretches: the one before them holds what a new run does first."""
    marks = output.sections.get(section, [])[-repeats - 1:]
    if len(marks) != repeats + 1:
        raise BenchmarkError(f"{len(marks)} marks in '{section}' where {repeats + 1} are needed")
    return cost_of([[pair] for pair in zip(marks, marks[1:])], timestep, sum(output.memory))


def time_liggghts(options, work, softness=1):
    """Costs at the paper's time step, in which a collision takes 185 steps, and at twice it.

    With ``softness`` the stiffness is that much lower and the steps are longer by its root, so as many a collision. Leaves the
    packing and the constants for in.lammps in ``work``.
    """
    longer = math.sqrt(softness)
    warm_up = math.ceil(options.dem_warm_up / (2 * PAPER_STEP * longer))
    variables = {"size": "paper", "out": work, "data": unpacked(work), "warm_up": warm_up, "softness": softness, "step": longer,
                 "stretch": options.steps, "stretches": options.repeats + 1}
    output = follow("LIGGGHTS, soft" if softness > 1 else "LIGGGHTS",
                    [*parallel(options.liggghts, options.cores), "-in", BENCHMARKS / "in.liggghts",
                     "-log", "none", *deck_variables(variables)], DEM_DECKS, options.cores)
    step = PAPER_STEP * longer * TAU
    return (dem_cost(output, "paper_step", step, options.repeats),
            dem_cost(output, "double_step", 2 * step, options.repeats))


def unpacked(work):
    """The packing in steady flow, as a plain file."""
    plain = work / "flowing.data"
    with gzip.open(BENCHMARKS / "flowing.data.gz") as packed, open(plain, "wb") as copy:
        shutil.copyfileobj(packed, copy)
    return plain


def time_lammps(options, work):
    variables = {"stretch": options.steps, "stretches": options.repeats + 1}
    output = follow("LAMMPS gran/hertz/history",
                    [*parallel(options.lammps, options.cores), "-in", BENCHMARKS / "in.lammps", "-log", "none",
                     *deck_variables(variables)], work, options.cores)
    return dem_cost(output, "paper_step", PAPER_STEP * TAU, options.repeats)


def time_spot(options, work):
    """Runs of the spot model, one a repeat, each with a seed of its own."""
    return [run_spot(f"spot model, seed {seed}", options.lmp, work / f"spot-{seed}", spot_deck(options.fix),
                     options.warm_up, options.measure, seed) for seed in range(1, options.repeats + 1)]


# --- Report -----------------------------------------------------------------------------------------------------------

def mean_quality(runs):
    """Means over the repeats; B of each beside them."""
    reference = Reference()
    each = [quality(one, reference) for one in runs]

    def mean(key):
        values = [one[key] for one in each]
        if isinstance(values[0], dict):
            return {z: statistics.fmean(value[z] for value in values) for z in values[0]}
        return statistics.fmean(values)
    return {**{key: mean(key) for key in each[0]}, "largest_overlap": max(one["largest_overlap"] for one in each),
            "snapshots": sum(one["snapshots"] for one in each), "snapshots_dem": each[0]["snapshots_dem"],
            "badness_ratios": [one["badness_ratio"] for one in each]}


def table(costs, ratios):
    lines = [f"{'':34}{'processor s / simulated s':>38}{'wall':>10}{'ms/step':>9}{'MB':>6}{'others':>8}{'ratio':>8}{'(from - to)':>18}"]
    for name, cost in costs.items():
        processor, wall = spread(cost.processor), spread(cost.wall)
        line = (f"{name:34}{processor['median']:14.4g} ({processor['min']:10.4g} -{processor['max']:10.4g})"
                f"{wall['median']:10.4g}{processor['median'] * cost.timestep * 1000:9.3g}{cost.memory:6.0f}{cost.others:8.2f}")
        if name in ratios:
            line += "{median:8.4g}{span:>18}".format(
                **ratios[name], span="({min:.4g} - {max:.4g})".format(**ratios[name]))
        lines.append(line)
    return "\n".join(lines)


def benchmark(options, work):
    runs = time_spot(options, work)
    spot = cost_of([one.pairs for one in runs], runs[0].timestep, max(one.memory for one in runs))
    interval = runs[0].interval
    packing = mean_quality(runs)
    paper, double = time_liggghts(options, work)
    lammps = time_lammps(options, work)
    _, soft = time_liggghts(options, work, softness=10)

    names = {"liggghts": ("LIGGGHTS", paper), "liggghts_double_step": ("LIGGGHTS, twice the time step", double),
             "liggghts_soft": ("LIGGGHTS, k_n / 10, 6.3 times it", soft),
             "lammps": ("LAMMPS gran/hertz/history", lammps)}
    ratios = {key: ratio(cost.processor, spot.processor) for key, (_, cost) in names.items()}
    flow = {"spots": statistics.fmean(one.spots() for one in runs),
            "moves_per_second": statistics.fmean(one.rate("moves") for one in runs)}
    result = {
        **{f"ratio_{key}": value["median"] for key, value in ratios.items()},
        "badness_ratio": packing["badness_ratio"], "cores": options.cores, "repeats": options.repeats,
        "ratios": ratios, "packing": packing,
        "programs": {"spot": {**spot.summary(), **flow}, **{key: cost.summary() for key, (_, cost) in names.items()}},
        "interval": {"spot_tau": interval, "dem_warm_up_tau": options.dem_warm_up, "dem_steps": options.steps},
        "fix_options": options.fix, **provenance(),
    }
    print(table({**dict(names.values()), "spot model": spot},
                {name: ratios[key] for key, (name, _) in names.items()}))
    print(f"B / B_DEM {packing['badness_ratio']:.3g} ({min(packing['badness_ratios']):.3g} - {max(packing['badness_ratios']):.3g}), "
          f"B {packing['badness']:.3g} in {packing['snapshots']} snapshots of {options.repeats} runs, B_DEM "
          f"{packing['badness_dem']:.3g} in {packing['snapshots_dem']}, {interval[0]:g} to {interval[1]:g} tau; outflow "
          f"{100 * packing['outflow_error']:+.1f} %, packing fraction {100 * packing['packing_fraction_error']:+.1f} % of DEM's; "
          f"{options.cores} core(s) for DEM, {options.repeats} repeats")
    warn_of_others({name: cost.others for name, cost in [*names.values(), ("spot model", spot)]})
    write_json(options.json, result)


# --- Command line -----------------------------------------------------------------------------------------------------

def parse():
    parser = command_line(__doc__)
    parser.add_argument("--cores", type=number(int, 1), default=1, help="MPI ranks of both DEM programs (default 1)")
    parser.add_argument("--repeats", type=number(int, 1), default=3,
                        help="runs of the spot model, with seeds 1, 2 ..., and timed stretches of each DEM program (default 3)")
    parser.add_argument("--steps", type=number(int, 1), default=1500, help="DEM steps in a stretch (default 1500)")
    parser.add_argument("--dem-warm-up", type=number(float, 0.01), default=0.5, metavar="TAU",
                        help="DEM flow before the first stretch, at twice the time step (default 0.5)")
    parser.add_argument("--measure", type=number(float, 2), default=18, metavar="TAU",
                        help="timed part of a run of the spot model (default 18)")
    parser.add_argument("--warm-up", type=number(float, 0), default=WARM_UP, metavar="TAU",
                        help=f"spot flow before it (default {WARM_UP}, when the number of spots is steady)")
    parser.add_argument("--fix", default="", metavar="'KEYWORD VALUE ...'", help="more words for fix spot, after those of the example")
    parser.add_argument("--lammps", default="lmp", type=program, help="LAMMPS with gran/hertz/history (default the lmp on the PATH)")
    parser.add_argument("--liggghts", default="liggghts", type=program, help="LIGGGHTS (default the one on the PATH)")
    options = parser.parse_args()
    if options.cores > os.cpu_count():
        parser.error(f"--cores: {options.cores} asked, this machine has {os.cpu_count()}")
    if options.cores > 1 and not shutil.which("mpirun"):
        parser.error("--cores: no mpirun on the PATH")
    return options


if __name__ == "__main__":
    sys.exit(run(benchmark, parse()))
