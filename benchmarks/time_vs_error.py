#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Run time against error of the spot model: the relaxation schedules of 2010, and tolerance, step height, window, alpha and
momentum of the windowed driver, in the silo of examples/silo. See README.md.
"""

import concurrent.futures
import json
import math
import pathlib
import statistics
import sys
from dataclasses import dataclass

from measuring import (WARM_UP, BenchmarkError, Reference, add_table_options, command_line, number, provenance, quality, run,
                       run_spot, say, spot_deck, stop_programs, warn_of_others, write_csv, write_json)

# "2010": Rycroft, Wong, Bazant, Powder Technology 200, 1-11, full drainage of 55,000 grains on one core of a 2.67 GHz Xeon.
# Setting -> seconds spent on relaxation, B over B of their DEM.
TABLE_2010 = {"every 1": (22446, 0.30), "chance 10": (2359, 2.2), "chance 100": (244, 7.8), "chance 1000": (23.8, 24),
              "spot 10": (1630, 2.2), "global 1": (261, 5.0), "global 10": (28.0, 17), "global 100": (2.8, 47),
              "never": (0, 137)}
RELAXATION_2010, DISPLACEMENT_2010 = 115e-6, 7.15e-6  # s a call
ALL_2010, DEM_2010 = 8 * 3600, 24 * 3 * 86400  # processor seconds of 'every 1' and of their DEM
# Of the run that made examples/silo/reference (its README.md), if there is no measurement on this machine.
DEM_PROCESSOR = 9.6e-3 / 1.749e-6  # s / simulated s

SLOW = 6  # tau; the timed part of settings that take minutes
REPORTED = ("processor", "badness_ratio", "rdf_rms_relative", "packing_fraction_error", "outflow_error", "largest_overlap")


@dataclass(frozen=True)
class Setting:
    family: str
    name: str
    words: str  # after those of the example's fix
    measure: float = math.inf  # tau, at most


UNIFORM = "profile uniform radius $(2.6*v_d)"  # 2006's and 2010's spots


def settings(full):
    def schedule(name):
        return Setting("2010 schedule", name, f"{UNIFORM} relax {name} dz $(0.1*v_d) alpha 0.8", SLOW if name == "every 1" else math.inf)

    def windowed(family, values, words):
        return [Setting(family, f"{family} {value:g}", words.format(value)) for value in values]

    return [
        *(Setting("accuracy", f"accuracy {name}", f"accuracy {name}", SLOW if name == "exact" else math.inf)
          for name in ("normal", "fast", "exact")),
        *map(schedule, ["every 1", "every 10", "every 100", "every 1000", "chance 10", "chance 100", "chance 1000", "spot 10",
                        "global 1", "global 10", "global 100", "never"]),
        *windowed("uniform", [1.5e-3, 2.1e-3, 2.6e-3, 3e-3, 3.8e-3, 5e-3], UNIFORM + " relax tol {}"),
        *windowed("tol", [1.5e-3, 2.1e-3, 2.6e-3, 3e-3, 3.4e-3, 3.8e-3, 4.4e-3, 5e-3, 6e-3, 8e-3, 1e-2], "relax tol {}"),
        *windowed("dz", [0.025] * full + [0.05, 0.1, 0.2, 0.4, 0.8, 1.2, 1.6], "dz $({}*v_d)"),
        *windowed("window", [0.01, 0.02, 0.04, 0.1, 0.2], "window $({}*v_tau)"),
        *windowed("alpha", [0.4, 0.6, 0.8, 1.0, 1.2, 1.4, 1.6], "alpha {}"),
        *windowed("momentum", [0, 0.3, 0.5, 0.7, 0.8, 0.9], "momentum {}"),
    ]


# --- Measuring --------------------------------------------------------------------------------------------------------

def measure(setting, seed, options, reference, work):
    """One run: a flat dictionary."""
    folder = work / f"{setting.name.replace(' ', '-')}-{seed}"
    one = run_spot(f"{setting.name}, seed {seed}", options.lmp, folder, spot_deck(f"{setting.words} {options.fix}"),
                   options.warm_up, min(setting.measure, options.measure), seed)
    cost = one.cost()
    packing = quality(one, reference)
    fluxes = {f"{name}_{z}d": value for name in ("flux_error", "flux_over_outflow") for z, value in packing.pop(name).items()}
    if not options.keep:
        for dump in folder.glob("*.dump"):
            dump.unlink()
    return {"processor": cost.processor[0], "wall": cost.wall[0], "others": cost.others, "memory": cost.memory,
            "moves": one.rate("moves"), "relaxations": one.rate("relaxations"), "spots": one.spots(), "interval": one.interval,
            **packing, **fluxes}


def point(setting, runs):
    """Means over the seeds, and the range of those numbers that are printed."""
    mean = {key: statistics.fmean(one[key] for one in runs) for key in runs[0] if key != "interval"}
    mean["largest_overlap"] = max(one["largest_overlap"] for one in runs)
    return {"family": setting.family, "setting": setting.name, "fix_options": setting.words, "seeds": len(runs),
            "interval_tau": runs[0]["interval"], **mean,
            "range": {key: [min(one[key] for one in runs), max(one[key] for one in runs)] for key in REPORTED}}


def measure_all(chosen, options, work):
    """Points in the order of ``chosen``; a setting that fails is told and left out."""
    reference = Reference()
    points = []
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        try:
            tasks = [(setting, [pool.submit(measure, setting, seed, options, reference, work)
                                for seed in range(1, options.seeds + 1)]) for setting in chosen]
            for setting, runs in tasks:
                try:
                    points.append(point(setting, [one.result() for one in runs]))
                    say(line(points[-1]))
                except BenchmarkError as error:
                    say(f"warning: {setting.name} is left out: {error}")
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            stop_programs()
            raise
    if not points:
        raise BenchmarkError("no setting could be measured")
    return points


# --- What is known already --------------------------------------------------------------------------------------------

def dem_points(path):
    """Processor seconds per simulated second of the DEM programs: of a file of against_dem.py, or of the reference run."""
    if not path:
        return {"DEM (reference run)": DEM_PROCESSOR}
    names = {"liggghts": "LIGGGHTS", "liggghts_double_step": "LIGGGHTS, 2 dt", "lammps": "LAMMPS"}
    try:
        programs = json.loads(path.read_text())["programs"]
        return {name: programs[key]["processor_seconds_per_second"]["median"] for key, name in names.items()}
    except (KeyError, TypeError, ValueError) as error:
        raise BenchmarkError(f"{path}: not a file of against_dem.py ({error})") from error


def points_2010(dem):
    """2010's table in our units. How much time they drained is not printed, but their DEM's time is: a point is placed where its ratio to
    their DEM is its ratio to our DEM. `processor` takes the part of their eight hours that was neither relaxation nor displacement to be
    the same for all schedules, `processor_least` to be nothing."""
    most, _ = TABLE_2010["every 1"]
    displacement = most / RELAXATION_2010 * DISPLACEMENT_2010
    rest = ALL_2010 - most - displacement
    return [{"family": "2010", "setting": name, "relaxation_seconds": relaxation, "displacement_seconds": displacement,
             "other_seconds": rest, "ratio_to_dem": DEM_2010 / (relaxation + displacement + rest),
             "ratio_to_dem_most": DEM_2010 / (relaxation + displacement),
             "processor": dem * (relaxation + displacement + rest) / DEM_2010,
             "processor_least": dem * (relaxation + displacement) / DEM_2010,
             "badness_ratio": badness} for name, (relaxation, badness) in TABLE_2010.items()]


# --- Report -----------------------------------------------------------------------------------------------------------

def line(one):
    return (f"{one['setting']:16}{one['processor']:10.4g}{one['wall']:10.4g}{one['relaxations']:12.4g}{one['badness_ratio']:9.3g}"
            f"{one['rdf_rms_relative']:8.3f}{100 * one['packing_fraction_error']:+8.2f}{100 * one['outflow_error']:+9.1f}"
            + "".join(f"{100 * one[f'flux_error_{z}d']:+8.1f}" for z in (2, 10, 30, 60)) + f"{one['largest_overlap']:10.4f}")


HEADER = (f"{'':16}{'processor':>10}{'wall':>10}{'relaxations':>12}{'B/B_DEM':>9}{'g(r)':>8}{'phi %':>8}{'outflow %':>9}"
          + "".join(f"{f'{z} d %':>8}" for z in (2, 10, 30, 60)) + f"{'overlap d':>10}")


def grains_relaxed(one, radius=3.6, half_depth=4.0, buffer=1.0):
    """About how many grains one relaxation of a schedule looks at: all, or those within R_s + 1 d of the middle of a step, less
    what the walls in front and behind cut off on average."""
    if one["setting"].startswith("global"):
        return one["grains"]
    offsets = [(half_depth - buffer) * (k + 0.5) / 100 for k in range(100)]
    caps = [max(0.0, radius - (half_depth - side * offset)) for offset in offsets for side in (-1, 1)]
    cut = sum(math.pi * cap**2 * (radius - cap / 3) for cap in caps) / len(offsets)
    return (4 / 3 * math.pi * radius**3 - cut) * one["packing_fraction"] * 6 / math.pi


def table_2010(points):
    """Relaxation time and B of each schedule beside 2010's, in units of the first; what relaxation costs is the difference to 'never'."""
    ours = {one["setting"]: one for one in points if one["family"] == "2010 schedule"}
    if not {"every 1", "never"} <= set(ours):
        return []
    never, most = ours["never"], ours["every 1"]["processor"] - ours["never"]["processor"]
    lines = ["", "The table of 2010: share of the relaxation time of 'every 1', and B / B_DEM",
             f"{'':16}{'time here':>12}{'2010':>10}{'B here':>10}{'2010':>10}{'grains swept / simulated s, about':>36}"]
    for name, (relaxation, badness) in TABLE_2010.items():
        if name in ours:
            share = (ours[name]["processor"] - never["processor"]) / most
            lines.append(f"{name:16}{share:12.4g}{relaxation / TABLE_2010['every 1'][0]:10.4g}"
                         f"{ours[name]['badness_ratio']:10.3g}{badness:10.3g}"
                         f"{ours[name]['relaxations'] * grains_relaxed(ours[name]):36.3g}")
    return lines


MARKERS = {"accuracy": "*", "2010 schedule": "s", "tol": "o", "dz": "D", "window": "v", "alpha": "^", "momentum": "P", "uniform": "X"}
PANELS = {"badness_ratio": "$B / B_{DEM}$", "rdf_rms_relative": "rms of g(r) to DEM, over DEM's since the start",
          "packing_fraction_error": "packing fraction, error (%)", "outflow_error": "outflow, error (%)",
          "flux_error_60d": "flux at 60 d, error (%)", "largest_overlap": "largest overlap (d)"}


def draw(path, points, published, dem):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(2, 3, figsize=(17, 10), constrained_layout=True)
    for axis, (key, label) in zip(axes.flat, PANELS.items()):
        percent = 100 if label.endswith("(%)") else 1
        for family, marker in MARKERS.items():
            group = sorted((one for one in points if one["family"] == family), key=lambda one: one["processor"])
            joined = "none" if family in ("2010 schedule", "accuracy") else "-"
            axis.plot([one["processor"] for one in group], [percent * one[key] for one in group], marker=marker, linestyle=joined,
                      linewidth=0.8, markersize=13 if family == "accuracy" else 5, label=f"{family}, here" if group else None)
            for one in group:
                if family in ("2010 schedule", "accuracy", "tol", "dz") and key == "badness_ratio":
                    axis.annotate(one["setting"], (one["processor"], one[key]), fontsize=7, xytext=(4, 3), textcoords="offset points")
        axis.set(xscale="log", xlabel="processor s / simulated s", ylabel=label)
        axis.grid(True, which="both", color="0.93")
        if key in ("badness_ratio", "largest_overlap"):
            axis.set_yscale("log")
        elif percent == 100:
            axis.axhline(0, color="0.7", linewidth=0.8)
    first = axes[0, 0]
    first.plot([one["processor"] for one in published], [one["badness_ratio"] for one in published], "x", color="0.4",
               label="2010, at its ratio to its own DEM; line: see README")
    for one in published:
        first.plot([one["processor_least"], one["processor"]], [one["badness_ratio"]] * 2, color="0.4", linewidth=0.8)
        first.annotate(one["setting"], (one["processor"], one["badness_ratio"]), fontsize=7, color="0.4", xytext=(4, -9),
                       textcoords="offset points")
    for name, processor in dem.items():
        first.plot(processor, 1, "kh", markersize=8)
        first.annotate(name, (processor, 1), fontsize=7, xytext=(0, 6), textcoords="offset points", rotation=60)
    first.axhline(1, color="0.7", linewidth=0.8)
    first.legend(fontsize=8)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def benchmark(options, work):
    dem = dem_points(options.dem)
    published = points_2010(next(iter(dem.values())))
    chosen = [setting for setting in settings(options.full) if not options.only or setting.family in options.only]
    if options.quick:
        chosen = [setting for number, setting in enumerate(chosen) if number % 3 == 1]
    say(f"{len(chosen)} settings, {options.seeds} seed(s), {options.warm_up:g} to {options.warm_up + options.measure:g} tau "
        f"(less for the slow ones), {options.jobs} at a time")
    points = measure_all(chosen, options, work)
    print(f"Per simulated second: processor s, wall s, relaxations (of one region, or of all cells that need one). Mean of {options.seeds} "
          "seed(s); errors are differences to DEM in the same interval", HEADER, *map(line, points), *table_2010(points), sep="\n")
    warn_of_others({one["setting"]: one["others"] - (options.jobs - 1) for one in points})
    about = provenance()
    known = [*published, *({"family": "DEM", "setting": name, "processor": processor, "badness_ratio": 1}
                           for name, processor in dem.items())]
    write_json(options.json, [{**one, "jobs": options.jobs, **about} for one in points] + [{**one, **about} for one in known])
    write_csv(options.csv, points)
    if options.png:
        draw(options.png, points, published, dem)


def parse():
    families = list(MARKERS)
    parser = command_line(__doc__)
    add_table_options(parser, "setting", "curves")
    parser.add_argument("--seeds", type=number(int, 1), default=1, metavar="N", help="runs of each setting, with seeds 1 to N (default 1)")
    parser.add_argument("--jobs", type=number(int, 1), default=1, metavar="N",
                        help="runs at a time (default 1, without which times are too high)")
    parser.add_argument("--warm-up", type=number(float, 0), default=WARM_UP, metavar="TAU", help=f"flow before (default {WARM_UP})")
    parser.add_argument("--measure", type=number(float, 2), default=18, metavar="TAU",
                        help=f"timed flow (default 18; at most {SLOW} for settings that take minutes)")
    parser.add_argument("--only", action="append", choices=families, metavar="FAMILY",
                        help=f"only these settings, may be given several times: {', '.join(families)}")
    parser.add_argument("--full", action="store_true", help="also dz 0.025")
    parser.add_argument("--quick", action="store_true", help="every third setting from 4 to 8 tau, to try this out; its numbers mean nothing")
    parser.add_argument("--fix", default="", metavar="'KEYWORD VALUE ...'", help="more words for fix spot, after those of each setting")
    parser.add_argument("--dem", metavar="FILE", type=pathlib.Path,
                        help="JSON of against_dem.py, for DEM's points (default: the cost of the reference run)")
    options = parser.parse_args()
    if options.quick:
        options.warm_up, options.measure = 4, 4
    return options


if __name__ == "__main__":
    sys.exit(run(benchmark, parse()))
