#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""What packing fraction and width of a flow follow, from dumps from the packing at rest on: the packing fraction against shear per
distance fallen, b_eff = v_x / (du/dx), u = -v_z, against what may collapse it, and the widths that laws of the sideways flux make. What
is fitted is fitted to DUMPS; OTHER is held against it."""

import argparse

from spot_analysis.base.interpreter import require_packages

require_packages("numpy", "scipy", "zstandard")

import numpy as np  # noqa: E402  (only after the check above)

from spot_analysis.base.errors import AnalysisError  # noqa: E402
from spot_analysis.base.progress import Progress, share_of  # noqa: E402
from spot_analysis.commands import command_line  # noqa: E402
from spot_analysis.reading.dump import find_dumps  # noqa: E402
from spot_analysis.statistics import flow_law, flow_places, fraction_law, widening  # noqa: E402
from spot_analysis.statistics.flow_sums import Measurement  # noqa: E402
from spot_analysis.statistics.interval import STEADY_FROM  # noqa: E402
from spot_analysis.statistics.snapshot import LAG_TAU, Snapshot  # noqa: E402

LAWS = {"no loss, b one number": ({"b": 1.4}, {"with_loss": False}), "b one number": ({"b": 1.4}, {}),
        "b falls with shear": ({"b": 1.9, "shear": 0.4}, {}), "towards dilation": ({"b": 1.4, "kappa": 0.4}, {}),
        "both": ({"b": 1.6, "shear": 1.0, "kappa": 0.3}, {})}


def interval(text):
    """(start, end) of START-END in tau."""
    try:
        start, end = map(float, text.split("-"))
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}' is no interval such as 40-90") from None
    if not 0 <= start < end:
        raise argparse.ArgumentTypeError(f"'{text}' must end after it starts")
    return start, end


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("dumps", metavar="DUMPS", help="folder, file or wildcard")
    parser.add_argument("--intervals", nargs="+", type=interval, metavar="START-END",
                        default=[(4, 10), (10, 20), (20, 40), (40, 90), (200, 304)],
                        help="in tau (default: 4-10 10-20 20-40 40-90 200-304)")
    parser.add_argument("--other", metavar="OTHER", help="another drainage, such as through a narrower orifice")
    parser.add_argument("--other-intervals", nargs="+", type=interval, metavar="START-END", default=[(4, 10), (10, 20), (20, 40)],
                        help="(default: 4-10 10-20 20-40)")
    command_line.add_scene_options(parser)
    command_line.add_scene_options(parser, "other-")
    return parser.parse_args()


class Run:
    """One drainage, measured: what the tables are made of."""

    def __init__(self, name, source, intervals, scene):
        self.name, self.container = name, scene.container()
        measured = Measurement(self.container, intervals)
        progress, files = Progress(source), len(find_dumps(source))
        for number, frame in enumerate(command_line.frames_of_equal_grains(source, scene), 1):
            measured.add(Snapshot(scene.time(frame.timestep), frame.ids, scene.positions(frame.positions), self.container, None))
            progress(f"t = {scene.time(frame.timestep):g} tau", share_of(number, files))
        self.intervals = {number: span for number, span in enumerate(measured.intervals) if measured.pairs(number)}
        if not self.intervals:
            raise AnalysisError(f"{source}: no two snapshots of an interval are {LAG_TAU:g} tau apart")
        self.fields = {number: measured.fields(number) for number in self.intervals}
        self.drained = {number: measured.drained(number) for number in self.intervals}
        self.places = flow_places.places(measured)
        steady = [number for number, (start, _) in self.intervals.items() if start >= STEADY_FROM]
        self.cells = [cells for cells in (fraction_law.cells(measured, number) for number in steady) if cells]

    def flowing(self):
        return flow_places.chosen(self.places, flow_law.flowing(self.places, self.container.half_width))

    def spans(self):
        return ", ".join(f"{start:g}-{end:g}" for start, end in self.intervals.values())


def table(columns, rows):
    print("| " + " | ".join(columns) + " |\n" + "|---" * len(columns) + "|")
    for row in rows:
        print("| " + " | ".join(row) + " |")
    print()


def listed(values, form="+.2f"):
    return " ".join(format(value, form) if np.isfinite(value) else "-" for value in values)


def print_fraction(run):
    """Packing fraction against s, from STEADY_FROM on."""
    if not run.cells:
        return
    all_cells = {name: np.concatenate([cells[name] for cells in run.cells]) for name in run.cells[0]}
    bulk = all_cells["z"] > fraction_law.BULK
    cells = {name: values[bulk] for name, values in all_cells.items()}
    print(f"Packing fraction in {len(cells['s'])} cells of {fraction_law.CELL} d, z > {fraction_law.BULK} d; "
          f"scatter of a cell {cells['noise'].std():.4f}\n")
    parts = np.array_split(np.argsort(cells["s"], kind="stable"), 8)
    table(["s (1/d)", "packing fraction", "standard deviation"],
          [[f"{cells['s'][part].mean():.3f}", f"{cells['fraction'][part].mean():.4f}", f"{cells['fraction'][part].std():.4f}"]
           for part in parts])
    low = ~bulk & (all_cells["x"] < 8)
    rows = []
    for name, form in (("s", "line"), ("s", "saturating"), ("s_full", "saturating"), ("z", "line"), ("strain", "saturating"),
                       ("fallen", "line")):
        found, residual = fraction_law.fit(cells[name], cells["fraction"], form)
        edge = residual[cells["share_of_axis"] < 0.2]
        below = all_cells["fraction"][low] - fraction_law.FORMS[form][0](all_cells[name][low], *found)
        rows.append([name, form, listed(found, ".4f"), f"{residual.std():.4f}",
                     *(f"{part.mean():+.4f}" if len(part) else "" for part in (edge, below))])
    table(["of", "form", "parameters", "rms", "off where u < 0.2 of the axis", "z < 8 d, x < 8 d"], rows)


def print_collapse(run, other):
    for title, rows, others in (("everywhere", run.places, other and other.places),
                                ("where the packing flows, 8 d from the walls", run.flowing(), other and other.flowing())):
        if len(rows["b"]) < 2 * flow_law.BINS:
            continue
        print(f"log b_eff {title}: {len(rows['b'])} places, standard deviation {np.log(rows['b']).std():.2f}, of which between the sides "
              f"{np.median(rows['noise']):.2f} (median); rank of b_eff of one side against shear_per_fall of the other "
              f"{flow_law.rank_across(rows):.2f}\n")
        found = {name: flow_law.collapse(rows, name, others) for name in flow_places.CANDIDATES}
        table(["of", "rank", "scatter", f"bias in {run.spans()} tau", f"{other.name}: bias, scatter" if other else "other"],
              [[name, f"{one.rank:.2f}", f"{one.scatter:.2f}", listed(one.bias),
                f"{one.other_bias:+.2f}, {one.other_scatter:.2f}" if other else ""]
               for name, one in sorted(found.items(), key=lambda item: item[1].scatter)])


def print_laws(run, other):
    """Laws of v_x / u, fitted where the packing of ``run`` flows."""
    rows, others = run.flowing(), other and other.flowing()
    if len(rows["b"]) < 2 * flow_law.BINS:
        return
    laws = {}
    for name, terms in flow_law.LAWS.items():
        found = flow_law.fit_inclination(rows, terms)
        laws[name] = listed(found, ".2f"), lambda at, terms=terms, found=found: flow_law.inclination_terms(at, terms) @ found
    for name, start in (("b falls with shear", (2.0, 0.4)), ("the same, kappa free", (2.0, 0.4, 0.0))):
        found, error = flow_law.fit_saturating(rows, start)
        laws[name] = (", ".join(f"{one:.2f} +- {its:.2f}" for one, its in zip(found, error)),
                      lambda at, found=found: flow_law.saturating(at, *found))
    print("Laws of v_x / u there\n")
    table(["law", "coefficients", "relative rms", f"bias in {run.spans()} tau", f"{other.name}: rms, bias" if other else "other"],
          [[name, text, f"{fitted.rms:.3f}", listed(fitted.bias), f"{apart.rms:.3f}, {listed(apart.bias)}" if other else ""]
           for name, (text, law) in laws.items()
           for fitted, apart in [(flow_law.misfit(rows, law(rows)), other and flow_law.misfit(others, law(others)))]])


def print_widths(run, other):
    runs = [one for one in (run, other) if one]
    print(f"Second moments at z = {', '.join(map(str, widening.HEIGHTS))} d (d^2), and Gaussian variances\n")
    table(["run", "tau", "grains drained", "second moments", "Gaussian variances"],
          [[one.name, "{:g}-{:g}".format(*one.intervals[number]), f"{one.drained[number]:.0f}",
            *(listed(column, ".1f") for column in zip(*found))]
           for one in runs for number, fields in one.fields.items()
           if (found := [widening.widths(widening.profile(fields.profile, z)) for z in widening.HEIGHTS if z <= fields.top])])
    fitted_to = [fields for number, fields in run.fields.items() if run.intervals[number][0] >= 10]
    if not fitted_to:
        return
    print("What laws make of the profile at z = 6 d: logarithm of their second moments over those of the run\n")
    rows = []
    for name, (start, fixed) in LAWS.items():
        law, rms = widening.fit(fitted_to, start, **fixed)
        for one in runs:
            for number, fields in one.fields.items():
                errors = widening.errors(fields, **law, **fixed)
                rows.append([name, listed(law.values(), ".2f"), f"{rms:.3f}", one.name, "{:g}-{:g}".format(*one.intervals[number]),
                             listed(errors[:, 0]) if len(errors) else ""])
    table(["law", "parameters", "rms of fit", "run", "tau", "errors"], rows)


def main():
    options = parse_arguments()
    run = Run("run", options.dumps, options.intervals, command_line.scene_from_options(options, options.dumps))
    other = options.other and Run("other", options.other, options.other_intervals,
                                  command_line.scene_from_options(options, options.other, "other-"))
    print_fraction(run)
    print_collapse(run, other)
    print_laws(run, other)
    print_widths(run, other)


if __name__ == "__main__":
    command_line.run(main)
