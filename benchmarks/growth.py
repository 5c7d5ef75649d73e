#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""How run time and memory of the spot model grow with the number of grains, from 5,000 to 1,000,000, and with the number of spots.

The packing of examples/silo is cut or repeated along x; there is always one orifice, so that more grains are more grains at rest.
Each silo runs with two timesteps, which tells what LAMMPS does in a step from what the spots cost. See README.md.
"""

import gzip
import math
import sys

import numpy as np

from measuring import (DIAMETER, EXAMPLE, WARM_UP, add_table_options, command_line, number, provenance, run, run_spot, say,
                       spot_deck, warn_of_others, write_csv, write_json)

WALL_OVERLAP = 0.014  # d; a little more than the largest in the example's packing
SPOT_SPEED = 3.0  # d/tau, of the example
# Grains -> half width and height (d) that are cut from the example's silo, and copies of it along x; odd, so that none ends at the orifice.
SILOS = {5_000: (10, 27, 1), 22_000: (10, 200, 1), 55_000: (25, 200, 1), 165_000: (25, 200, 3), 495_000: (25, 200, 9),
         1_045_000: (25, 200, 19)}
EXAMPLE_GRAINS = 55_000
OUTFLOWS = [0.5, 1, 2, 4]  # of the example's
TIMESTEP, LONG_TIMESTEP = 0.2, 2  # tau; with the second, LAMMPS does a tenth as much


def example_grains():
    """Positions (n, 3), d"""
    with gzip.open(EXAMPLE / "packing.data.gz", "rt") as lines:
        rows = [line.split() for line in lines]
    return np.array([row[4:7] for row in rows if len(row) == 7 and row[0].isdigit()], dtype=float) / DIAMETER


def write_packing(path, grains, half_width, height, copies):
    """Returns the number of grains and half the width of the silo (d)."""
    kept = grains[(np.abs(grains[:, 0]) < half_width - 0.5 + WALL_OVERLAP) & (grains[:, 2] < height)]
    shifts = 2 * half_width * (np.arange(copies) - copies // 2)
    all_grains = np.concatenate([kept + (shift, 0, 0) for shift in shifts]) * DIAMETER
    wide, top = half_width * copies, max(180, kept[:, 2].max() + 10)
    with open(path, "w", encoding="ascii") as out:
        out.write(f"Glass beads\n\n{len(all_grains)} atoms\n1 atom types\n\n{-wide * DIAMETER:.9g} {wide * DIAMETER:.9g} xlo xhi\n"
                  f"{-4 * DIAMETER} {4 * DIAMETER} ylo yhi\n{-11 * DIAMETER} {top * DIAMETER:.9g} zlo zhi\n\nAtoms # sphere\n\n")
        out.writelines(f"{number} 1 {DIAMETER} 2500 {x:.9g} {y:.9g} {z:.9g}\n" for number, (x, y, z) in enumerate(all_grains, 1))
    return len(all_grains), wide


def measure(silo, outflow, grains, options, work):
    """A flat dictionary."""
    half_width, height, copies = SILOS[silo]
    folder = work / f"{silo}-{outflow:g}"
    folder.mkdir(parents=True)
    count, wide = write_packing(folder / "packing.data", grains, half_width, height, copies)
    # A low silo is steady earlier, and empty sooner.
    warm_up, measured = (min(time, height / SPOT_SPEED) for time in (options.warm_up, options.measure))

    def flow(timestep):
        # Before there is a fix, LAMMPS says what memory it needs by itself.
        deck = spot_deck(f"outflow $({outflow}*v_outflow/v_tau) {options.fix}", folder / "packing.data", wide, timestep, ["run 0"])
        return run_spot(f"{count:,} grains, outflow x {outflow:g}, steps of {timestep} tau", options.lmp, folder, deck, warm_up,
                        measured, apart=measured, dumps=False)

    # The same trajectory every time: the fastest was disturbed least.
    one, long = (min((flow(timestep) for _ in range(options.repeats)), key=lambda spot: spot.cost().processor[0])
                 for timestep in (TIMESTEP, LONG_TIMESTEP))
    (folder / "packing.data").unlink()
    costs = [one.cost(), long.cost()]
    processor, with_long = (cost.processor[0] for cost in costs)
    step = (processor - with_long) / (1 / one.timestep - 1 / long.timestep)  # s
    spots = processor - step / one.timestep
    return {"grains": count, "outflow": outflow, "spots": one.spots(), "moves_per_second": one.rate("moves"),
            "processor": processor, "wall": costs[0].wall[0], "microseconds_per_grain": 1e6 * processor / count,
            "processor_of_spots": spots, "microseconds_per_move": 1e6 * spots / one.rate("moves"),
            "nanoseconds_per_grain_and_step": 1e9 * step / count,
            "bytes_per_grain": 1e6 * (one.allocated[1] - one.allocated[0]) / count,
            "peak_bytes_per_grain_of_program": 1e6 * one.memory / count,
            "interval_tau": one.interval, "others": max(cost.others for cost in costs)}


COLUMNS = {"grains": ("grains", "10,d"), "outflow": ("outflow", "10g"), "spots": ("spots", "8.0f"),
           "processor": ("processor", "11.4g"), "microseconds_per_grain": ("us/grain", "10.4g"),
           "processor_of_spots": ("of spots", "10.4g"), "microseconds_per_move": ("us/move", "9.3g"),
           "nanoseconds_per_grain_and_step": ("ns/grain/step", "14.3g"), "bytes_per_grain": ("B/grain", "9.0f"),
           "peak_bytes_per_grain_of_program": ("peak, all", "11.0f")}
HEADER = "".join(title.rjust(int(form.split(".")[0].rstrip(",dg"))) for title, form in COLUMNS.values())


def line(one):
    return "".join(format(one[key], form) for key, (_, form) in COLUMNS.items())


def draw(path, points):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    sizes = [one for one in points if one["outflow"] == 1]
    outflows = sorted((one for one in points if one["grains"] == at_example(points)), key=lambda one: one["outflow"])
    figure, (by_size, by_spots, memory) = plt.subplots(1, 3, figsize=(15, 4.5), constrained_layout=True)
    grains = [one["grains"] for one in sizes]
    by_size.plot(grains, [one["microseconds_per_move"] for one in sizes], "o-", label="of a move of a spot (us)")
    by_size.plot(grains, [one["nanoseconds_per_grain_and_step"] for one in sizes], "s--", label="of a grain and LAMMPS step (ns)")
    by_size.set(xlabel="grains", ylabel="processor time", xscale="log", yscale="log")
    by_spots.plot([one["spots"] for one in outflows], [one["microseconds_per_move"] for one in outflows], "o-")
    by_spots.set(xlabel=f"spots alive, {outflows[0]['grains']:,} grains", ylabel="processor time of a move (us)",
                 xscale="log", ylim=(0, 1.3 * max(one["microseconds_per_move"] for one in outflows)))
    memory.plot(grains, [one["bytes_per_grain"] for one in sizes], "o-", label="fix spot")
    memory.plot(grains, [one["peak_bytes_per_grain_of_program"] for one in sizes], "s--", label="peak of the whole program")
    memory.axhline(1000, color="0.7", linewidth=0.8)
    memory.set(xlabel="grains", ylabel="memory (bytes a grain)", xscale="log", yscale="log")
    by_size.legend(fontsize=8)
    memory.legend(fontsize=8)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def at_example(points):
    """The number of grains for which the outflow was varied."""
    return max((one["grains"] for one in points), key=lambda count: (sum(one["grains"] == count for one in points), count))


def benchmark(options, work):
    grains = example_grains()
    silos = [silo for silo in SILOS if silo <= options.largest]
    cases = [(silo, 1) for silo in silos]
    cases += [(EXAMPLE_GRAINS, outflow) for outflow in OUTFLOWS if outflow != 1 and EXAMPLE_GRAINS in silos]
    points = []
    for silo, outflow in cases:
        points.append(measure(silo, outflow, grains, options, work))
        say(line(points[-1]))
    print("Processor s per simulated s, a grain's share, what is left without LAMMPS steps, of it a move; a step, a grain's share; "
          "memory of fix spot, and peak of the program", HEADER, *map(line, points), sep="\n")
    warn_of_others({f"{one['grains']:,} grains": one["others"] for one in points})
    about = provenance()
    write_json(options.json, [{**one, **about} for one in points])
    write_csv(options.csv, points)
    if options.png:
        draw(options.png, points)


def parse():
    parser = command_line(__doc__)
    add_table_options(parser, "case", "numbers")
    parser.add_argument("--warm-up", type=number(float, 0), default=WARM_UP, metavar="TAU",
                        help=f"flow before (default {WARM_UP}; less in low silos)")
    parser.add_argument("--measure", type=number(float, 2), default=16, metavar="TAU", help="timed flow (default 16; less in low silos)")
    parser.add_argument("--repeats", type=number(int, 1), default=2, help="runs of each case, of which the fastest counts (default 2)")
    parser.add_argument("--largest", type=number(float, min(SILOS)), default=math.inf, metavar="N", help="no more grains than this")
    parser.add_argument("--quick", action="store_true", help="up to 55,000 grains, 2 to 6 tau, to try this out; its numbers mean nothing")
    parser.add_argument("--fix", default="", metavar="'KEYWORD VALUE ...'", help="more words for fix spot, after those of the example")
    options = parser.parse_args()
    if options.quick:
        options.warm_up, options.measure, options.largest = 2, 4, EXAMPLE_GRAINS
    return options


if __name__ == "__main__":
    sys.exit(run(benchmark, parse()))
