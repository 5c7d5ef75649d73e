#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""One set of parameters for every DEM reference of the material: runs the deck on each with several seeds and prints one table
by family of quantities, with a DEM twin and two baselines beside the spot model."""

import argparse
import math
import os
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field

from spot_analysis.base.interpreter import require_packages

require_packages("numpy", "scipy", "matplotlib", "zstandard")

import baseline  # noqa: E402  (only after the check above)
from spot_analysis.base.errors import AnalysisError  # noqa: E402
from spot_analysis.base.progress import counted  # noqa: E402
from spot_analysis.commands import command_line, deck_run  # noqa: E402
from spot_analysis.reading.dump import read_frames  # noqa: E402
from spot_analysis.reading.scene import load_scene  # noqa: E402
from spot_analysis.report import criteria, families, family_table  # noqa: E402
from spot_analysis.report.by_name import by_name  # noqa: E402
from spot_analysis.statistics import run_statistics  # noqa: E402

FOLDER = os.path.dirname(os.path.abspath(__file__))
SILO = os.path.join(FOLDER, os.pardir, "examples", "silo")
TAU = math.sqrt(0.003 / 9.81)  # s, of the deck
BASELINES = ("nothing", "kinematic")
# What is built into the deck's parameters and can be switched off: name -> {"options": words for fix spot, "variables": {}}.
INGREDIENTS = {
    "critical": {"variables": {"critical": "0", "dilatancy": "0", "full_strain": "0"}},
    # 0.62, less what front and back shear off. Without kappa they would not strain enough for a full exchange.
    "spread": {"variables": {"spread": "0", "wall_shear": "0", "critical": "0.602", "full_strain": "0"}},
    "dilatancy": {"variables": {"critical": "0.5915", "dilatancy": "0"}},  # a phi_c that gives the same mean, with no shear in it
    "full-strain": {"variables": {"full_strain": "0"}},
    "surface": {"variables": {"surface": "0"}},
    "nonaffine": {"variables": {"nonaffine": "0"}},
    "closing": {"variables": {"closing_gap": "0"}},
    "one-speed": {"variables": {"dilation": "0.03", "speed": f"{2.5 * 0.003 / TAU:g}"}},  # v_s (c / c_0)^2, as before it
}


@dataclass(frozen=True)
class Reference:
    """A DEM run and how the deck drains the same silo.

    statistics, twins : files of measure.py in examples/silo; twins are further DEM runs of the same silo
    outflow : DEM's, grains a tau, which births of spots follow
    variables : of the deck; packing : file in examples/silo
    windows : window -> (start, end), tau; by default those of ``criteria.WINDOWS`` that the run reaches
    not_carried : pattern of the labels of criteria -> why DEM's run cannot carry them, besides the time at which it ends
    """

    statistics: str
    outflow: float
    twins: tuple = ()
    packing: str = "packing.data.gz"
    variables: dict = field(default_factory=dict)
    windows: dict = None
    not_carried: dict = field(default_factory=dict)

    def load(self):
        """Statistics of DEM and of its twins."""
        return [run_statistics.load(os.path.join(SILO, path)) for path in (self.statistics, *self.twins)]

    def windows_of(self, run):
        return self.windows or criteria.windows_of(run.times[-1])

    def deck_variables(self, seed, last):
        """name -> text; last : tau, when the run ends."""
        return {"packing": os.path.abspath(os.path.join(SILO, self.packing)), "outflow": f"{self.outflow:g}", **self.variables,
                "seed": str(seed), "time": f"{last * TAU:.9g}"}

    def why_not(self, criterion, run):
        """Why the reference, RunStatistics, does not carry a Criterion; None if it does."""
        end = run.times[-1]
        if criterion.window is None and float(criterion.name.split("_")[-1].removesuffix("tau")) > end:
            return f"the run ends at {end:g} tau"
        if criterion.window is not None and criterion.window not in self.windows_of(run):
            return f"the run ends at {end:g} tau"
        if criterion.name.startswith(run.lacking):
            return "its dumps were measured before this was, and are gone"
        return by_name(self.not_carried, criterion.label, None)


CENSORED = "grains may have stayed for longer than since the start"
LOW = "the surface comes down to 52 d, from 65 d"
ABOVE = {
    "particle_diffusion*": "is measured up to 70 d, above the bed", "frame_correlation*": "is measured up to 70 d, above the bed",
    "correlation*": "is measured up to 70 d, above the bed", "residence_*_20d*": CENSORED,
    "stagnant_boundary_30d*": "grains move up to the side walls",
}
NARROW = {"flux_60d*": LOW, "density_drop*": LOW, "arrival_[69]0d*": LOW, "*_variance_50d*": LOW, **ABOVE}
SHORT = "the run is 50 tau long"
STARTING = "the flow is still starting, at 8-18 tau"
REFERENCES = {
    "reference": Reference("reference/dem-statistics.npz", 69.6, ("reference-twin/dem-statistics.npz",),
                           not_carried={"residence_p84_20d, early": CENSORED}),
    "reference-dense": Reference("reference-dense/dem-statistics.npz", 70.2, packing="reference-dense/packing.data.gz",
                                 not_carried={"residence_p84_20d, early": CENSORED}),
    # The mean of its two runs at 20-50 tau, 69.6, and of the longer one at 50-80 tau, 72.0.
    "walls-16": Reference("out-of-sample/walls-16.npz", 70.8, ("out-of-sample/walls-16-twin.npz",),
                          packing="out-of-sample/packing.data.gz", variables={"half_width": "16"},
                          windows={"early": (20.0, 50.0), "late": (50.0, 80.0)},
                          not_carried={**NARROW, "stagnant_boundary_20d*": NARROW["stagnant_boundary_30d*"],
                                       "packing_fraction_80_100tau": "the surface comes down to 39 d"}),
    "orifice-6.5": Reference("out-of-sample/orifice-6.5.npz", 31.9, ("out-of-sample/orifice-6.5-twin.npz",),
                             packing="out-of-sample/packing.data.gz", variables={"half_width": "16", "orifice": "6.5"},
                             windows={"early": (20.0, 50.0), "late": (90.0, 140.0)},
                             not_carried={**NARROW, "residence_p84_10d*": CENSORED,
                                          "stagnant_boundary_20d, late": NARROW["stagnant_boundary_30d*"],
                                          "arrival_*": "the flux through 30 d still grows at 50 tau"}),
    # Out of sample: nothing has been fitted to it. It has no walls across y.
    "periodic-depth": Reference("periodic-depth/dem-statistics.npz", 59.0, packing="periodic-depth/packing.data.gz",
                                variables={"half_width": "16", "half_depth": "8", "periodic": "1"}, windows={"early": (20.0, 50.0)},
                                not_carried={**ABOVE, "density_drop*": "the surface comes down to 66 d, from 70 d", "arrival_*": SHORT,
                                             "residence_median_10d*": CENSORED, "residence_p84_10d*": CENSORED,
                                             "stagnant_boundary_[12]0d*": ABOVE["stagnant_boundary_30d*"],
                                             "speed_wall_over_middle*": "there are no walls across y",
                                             "largest_overlap*": "DEM's own is 0.022 d"}),
    "half-full": Reference("out-of-sample/half-full.npz", 70.0, packing="out-of-sample/half-full-packing.data.gz",
                           windows={"early": (20.0, 60.0), "late": (90.0, 180.0)},
                           not_carried={"outflow, late": "the silo runs empty", "surface_angle_*": None, "outflow, early": None,
                                        "*": "the bed is 25 d high: it is for heaps"}),
    "tall": Reference("out-of-sample/tall.npz", 69.9, packing="out-of-sample/tall-packing.data.gz", windows={"early": (8.0, 18.0)},
                      not_carried={"residence_*": CENSORED, "packing_*": "one packing at 10 tau", "flux_60d*": STARTING,
                                   "arrival_*": STARTING, "*_variance_50d*": STARTING, "particle_diffusion*": STARTING,
                                   "frame_correlation*": STARTING, "correlation*": STARTING}),
}


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", metavar="FOLDER", help="keeps statistics of every run; those there are not made again")
    parser.add_argument("--only", nargs="+", choices=REFERENCES, default=list(REFERENCES), metavar="REFERENCE",
                        help=f"of {', '.join(REFERENCES)}")
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3], metavar="N")
    parser.add_argument("--without", nargs="+", choices=INGREDIENTS, default=[], metavar="INGREDIENT",
                        help=f"switch off, of {', '.join(INGREDIENTS) or 'none that there are'}")
    parser.add_argument("--options", default="", metavar="WORDS", help="more words for fix spot")
    parser.add_argument("--set", nargs="+", default=[], metavar="NAME=VALUE", help="variables of the deck")
    parser.add_argument("--no-baselines", action="store_true", help="leave out the two baselines, on the first reference")
    parser.add_argument("--rows", action="store_true", help="only print which rows each reference carries, and why not")
    parser.add_argument("--lmp", default=os.path.join(FOLDER, os.pardir, "build", "bin", "lmp"), metavar="COMMAND")
    parser.add_argument("--deck", default=os.path.join(SILO, "in.silo_spot"), metavar="FILE")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="runs at a time (default: %(default)d)")
    options = parser.parse_args()
    if options.output is None and not options.rows:
        parser.error("-o FOLDER is missing")
    if options.jobs < 1:
        parser.error(f"--jobs is {options.jobs} but must be at least 1")
    return options


def chosen_variables(options):
    """Variables of the deck from --set, --options and --without, which win over those of a reference."""
    variables = {}
    for words in options.set:
        name, equals, value = words.partition("=")
        if not (name and equals and value):
            raise AnalysisError(f"--set: '{words}' is not NAME=VALUE")
        if name in ("options", "out", "seed", "time", "packing"):
            raise AnalysisError(f"--set: '{name}' is chosen here; see --options, --output, --seeds, --only")
        variables[name] = value
    switched = [INGREDIENTS[name] for name in options.without]
    words = [one.get("options", "") for one in switched] + [options.options]
    for one in switched:
        variables.update(one.get("variables", {}))
    return {**variables, "options": " ".join(["accuracy normal", *filter(None, words)])}


def run_spot(task):
    """Statistics of one run of the spot model at the times of DEM's snapshots; task : name, seed, times, and the options."""
    name, seed, times, options = task
    variables = {**REFERENCES[name].deck_variables(seed, times[-1]), **chosen_variables(options)}
    label = f"{name}, seed {seed}"
    return deck_run.kept(os.path.join(options.output, f"{name}.{seed}.npz"), deck_run.settings_of(options.deck, variables, times),
                         label, lambda dumps: deck_run.run_deck(options.lmp, options.deck, variables, dumps, label), times=times)


def run_baseline(model, name, times, options):
    """Statistics of a baseline that starts from the reference's packing; the deck turns that into a dump."""
    reference = REFERENCES[name]
    variables = {**reference.deck_variables(1, 2.0), **chosen_variables(options)}

    def make(dumps):
        packing = f"{dumps}.packing"
        deck_run.run_deck(options.lmp, options.deck, variables, packing, f"{name}, packing")
        baseline.write_baseline(dumps, model, next(read_frames(packing)), load_scene(packing), times, reference.outflow)
        deck_run.remove(packing)

    return deck_run.kept(os.path.join(options.output, f"{name}.{model}.npz"),
                         deck_run.settings_of(options.deck, {**reference.deck_variables(1, 2.0), "model": model}, times),
                         f"{name}, {model}", make, times=times)


def run_all(options, dems):
    """reference -> RunStatistics of the spot model, a seed each."""
    tasks = [(name, seed, dems[name][0].times, options) for name in options.only for seed in options.seeds]
    if options.jobs == 1:
        runs = counted(map(run_spot, tasks), len(tasks), "runs")
    else:
        with ProcessPoolExecutor(options.jobs) as pool:
            runs = list(counted(pool.map(run_spot, tasks), len(tasks), "runs"))
    found = {}
    for (name, *_), run in zip(tasks, runs):
        found.setdefault(name, []).append(run)
    return found


def rows_table(dems):
    """Which criteria each reference carries, as Markdown, with the reasons why not."""
    reasons, lines = [], [["", "bound", *dems]]
    for criterion in criteria.CRITERIA:
        cells = []
        for name, (run, *_) in dems.items():
            reason = REFERENCES[name].why_not(criterion, run)
            if reason and reason not in reasons:
                reasons.append(reason)
            cells.append(f"- ({reasons.index(reason) + 1})" if reason else "yes")
        lines.append([f"{criterion.family}: {criterion.label}", criterion.bound.text() if criterion.bound else "reported", *cells])
    outflow = ["outflow asked for (1/tau)", "", *(f"{REFERENCES[name].outflow:g}" for name in dems)]
    numbered = "\n".join(f"{number}. {reason}" for number, reason in enumerate(reasons, 1))
    return f"{family_table.markdown([*lines, outflow])}\n\nWhy not:\n\n{numbered}"


def heading(name, run):
    """The reference and its windows."""
    spans = ", ".join(f"{window} {start:g}-{end:g}" for window, (start, end) in REFERENCES[name].windows_of(run).items())
    return f"{name} ({spans} tau)"


def judge(name, dems, runs):
    """Criterion -> Verdict of ``runs`` against DEM."""
    reference = REFERENCES[name]
    reasons = {criterion.label: reason for criterion in criteria.CRITERIA if (reason := reference.why_not(criterion, dems[0]))}
    return families.judge(dems, runs, reference.windows_of(dems[0]), reasons)


def main():
    options = parse_arguments()
    dems = {name: REFERENCES[name].load() for name in options.only}
    if options.rows:
        print(rows_table(dems))
        return
    os.makedirs(options.output, exist_ok=True)
    chosen_variables(options)
    columns = {heading(name, dems[name][0]): judge(name, dems[name], runs) for name, runs in run_all(options, dems).items()}
    for name in options.only:
        for number, twin in enumerate(dems[name][1:], 1):
            columns[f"{name}: DEM twin {number}"] = judge(name, dems[name][:1], [twin])
    if not options.no_baselines:
        first = options.only[0]
        for model in BASELINES:
            run = run_baseline(model, first, dems[first][0].times, options)
            columns[f"{first}: {model}"] = judge(first, dems[first], [run])
    text = family_table.markdown(family_table.rows(columns))
    with open(os.path.join(options.output, "table.md"), "w", encoding="utf-8") as handle:
        handle.write(text + "\n")
    print(text)


if __name__ == "__main__":
    command_line.run(main)
