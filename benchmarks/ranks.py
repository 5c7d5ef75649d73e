#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""How the spot model scales over MPI ranks and threads: time, memory of each rank, what ranks tell each other in a window, and
what follows from that for more ranks than this machine has. See README.md.
"""

import concurrent.futures
import csv
import io
import math
import os
import shutil
import statistics
import subprocess
import sys
from dataclasses import dataclass

import numpy as np

from growth import SPOT_SPEED, example_grains, write_packing
from measuring import (EXAMPLE, ROOT, WARM_UP, BenchmarkError, add_table_options, command_line, number, program, provenance, run,
                       run_spot, say, spot_deck, stop_programs, warn_of_others, write_csv, write_json)

HALF_WIDTH = 25  # d, of the example's silo
STUDIES = ("strong", "weak", "memory", "communication")


# --- Time -------------------------------------------------------------------------------------------------------------

@dataclass(frozen=True)
class Case:
    """``at_once`` runs of it at the same time."""

    name: str
    ranks: int = 1
    threads: int = 1
    at_once: int = 1


# What two runs that have nothing to do with each other lose to each other, two ranks lose, too.
CASES = (Case("1 rank"), Case("2 ranks", ranks=2), Case("2 threads", threads=2), Case("two runs of 1 rank", at_once=2),
         Case("4 ranks", ranks=4))


def steady_state(name, options, work, height=math.inf):
    """A restart file of the example's silo, or of the part of its packing below a height (d), once the flow is steady."""
    folder = work / name.replace(" ", "-")
    folder.mkdir()
    write_packing(folder / "packing.data", example_grains(), HALF_WIDTH, height, 1)
    deck = spot_deck(options.fix, folder / "packing.data") + f"write_restart {folder / 'steady'}\n"
    warm_up = min(options.warm_up, 2 * (height / SPOT_SPEED // 2))
    run_spot(f"{name}, warm-up", options.lmp, folder, deck, warm_up - 2, 2, dumps=False)
    return folder / "steady"


def go_on(case, state, options, folder):
    """The runs of a case, from a steady state."""
    def one(copy):
        deck = spot_deck(f"{options.fix} threads {case.threads}", restart=state)
        return run_spot(case.name, options.lmp, folder / str(copy), deck, 2, options.measure, ranks=case.ranks)

    with concurrent.futures.ThreadPoolExecutor(case.at_once) as pool:
        try:
            return list(pool.map(one, range(case.at_once)))
        except BaseException:
            stop_programs()
            raise


def times(study, case, runs):
    """A row: medians over the runs of a case, and what part of a processor others used."""
    costs = [one.cost() for one in runs]
    walls, processors = ([value for cost in costs for value in getattr(cost, clock)] for clock in ("wall", "processor"))
    return {"study": study, "case": case.name, "ranks": case.ranks, "threads": case.threads, "runs": len(runs),
            "wall": statistics.median(walls), "wall_least": min(walls), "wall_most": max(walls),
            "processor": statistics.median(processors), "moves_per_second": runs[0].rate("moves"),
            "others": max(0.0, max(cost.others for cost in costs) - (case.at_once - 1))}


def dumps(one):
    return {path.name: path.read_bytes() for path in one.folder.glob("spot.*.dump")}


def strong(options, work):
    """The same silo on more ranks or threads. Every repeat goes through all cases, so that all see the same machine."""
    state = steady_state("whole silo", options, work)
    runs = {case: [] for case in CASES}
    for repeat in range(options.repeats):
        for case in CASES:
            runs[case] += go_on(case, state, options, work / f"strong-{repeat}-{case.name.replace(' ', '-')}")
    rows = [times("strong", case, found) for case, found in runs.items()]
    first = dumps(runs[CASES[0]][0])
    for row, case in zip(rows, CASES):
        row["speedup"] = case.at_once * rows[0]["wall"] / row["wall"]
        row["same_dumps"] = all(dumps(one) == first for one in runs[case])
    return rows


def weak(options, work):
    """Half of the silo's height on one rank, all of it on two: half of the spots and moves each."""
    height = example_grains()[:, 2].max() / 2
    cases = {Case("half the height, 1 rank"): steady_state("half the height", options, work, height),
             Case("the whole, 2 ranks", ranks=2): steady_state("all of it", options, work)}
    runs = {case: [] for case in cases}
    for repeat in range(options.repeats):
        for case, state in cases.items():
            runs[case] += go_on(case, state, options, work / f"weak-{repeat}-{case.ranks}")
    rows = [times("weak", case, found) for case, found in runs.items()]
    for row in rows:
        row["us_per_move_and_rank"] = 1e6 * row["wall"] / (row["moves_per_second"] / row["ranks"])
        row["efficiency"] = rows[0]["us_per_move_and_rank"] / row["us_per_move_and_rank"]
    return rows


# --- Memory -----------------------------------------------------------------------------------------------------------

def tall_packing(grains, count):
    """So many grains, copies of the example's bulk on top of each other, a diameter apart so that none overlap."""
    bottom, top = 5, 105  # d; of the bulk
    bulk = grains[grains[:, 2] < top]
    slab = bulk[bulk[:, 2] >= bottom]
    copies = 1 + math.ceil((count - len(bulk)) / len(slab))
    stack = np.concatenate([bulk, *(slab + (0, 0, copy * (top - bottom + 1)) for copy in range(1, copies))])
    return stack[np.argsort(stack[:, 2], kind="stable")[:count]]


def memory(options, work):
    """Largest resident memory of every rank, set-up included, over two steps."""
    grains = example_grains()
    silos = {"the example's": (grains, 1), "135,000, tall": (tall_packing(grains, 135_000), 1), "19 copies, wide": (grains, 19)}
    rows = []
    for name, (packing, copies) in silos.items():
        data = work / "packing.data"
        count, wide = write_packing(data, packing, HALF_WIDTH, math.inf, copies)
        for ranks in (1, 2, 4):
            one = run_spot(f"{name}, {ranks} rank(s)", options.lmp, work / f"memory-{count}-{ranks}",
                           spot_deck(options.fix, data, wide, timestep=0.5), 0, 1, apart=0.5, dumps=False, ranks=ranks)
            rows.append({"study": "memory", "case": name, "grains": count, "ranks": ranks,
                         "memory_most": one.memory_of_ranks[0], "memory_least": one.memory_of_ranks[-1], "memory_all": one.memory})
        data.unlink()
    return rows


# --- What ranks tell each other ---------------------------------------------------------------------------------------

KINDS = ("moves", "shares", "weights", "migrants", "border", "reductions")


def count_traffic(options):
    """Microseconds that a birth takes to draw, and what each rank said: dictionaries of floats, per window."""
    command = [options.counter, EXAMPLE / "packing.data.gz", options.warm_up, 1, *options.ranks * options.repeats]
    say("counting what ranks tell each other")
    # On one processor: what a rank has to do must not depend on which others are at work beside it.
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True,
                          preexec_fn=lambda: os.sched_setaffinity(0, {min(os.sched_getaffinity(0))}))
    if done.returncode:
        raise BenchmarkError(done.stderr.strip() or f"{options.counter} failed")
    births, table = done.stdout.split("\n", 1)
    found = {}
    for row in csv.DictReader(io.StringIO(table)):
        one = {key: float(value) for key, value in row.items()}
        found.setdefault((one["ranks"], one["rank"]), []).append(one)
    # The repeats differ in processor time only: the fastest was disturbed least.
    return float(births.split()[1]), [min(runs, key=lambda one: one["processor_ms"]) for runs in found.values()]


def communication(said):
    """For each number of ranks, the largest value of any rank."""
    rows = []
    for ranks in sorted({int(one["ranks"]) for one in said}):
        group = [one for one in said if one["ranks"] == ranks]
        rows.append({"study": "communication", "case": "the example's", "ranks": ranks,
                     **{key: max(one[key] for one in group) for key in group[0] if key not in ("ranks", "rank")},
                     "processor_mean_ms": statistics.fmean(one["processor_ms"] for one in group)})
    return rows


# --- More ranks than there are here -----------------------------------------------------------------------------------

LATENCY, BANDWIDTH = 2e-6, 1e10  # s of a message; bytes/s of a rank: a cluster's network, not measured here
DENSITY = 0.574 * 6 / math.pi  # grains in d^3
EDGE, REACH = 1.5, 3.88  # d; of a cell, and of a move (TiledPacking)
AREA = 2 * HALF_WIDTH * 8  # d^2, cross-section of the example's silo
BIRTHS = 60  # a window in it


def measured_inputs(birth_us, said):
    """What the model takes from the counts; seconds, bytes, each a window."""
    alone = next(one for one in said if one["ranks"] == 1)
    between = max((one for one in said if 0 < one["rank"] < one["ranks"] - 1), key=lambda one: one["border_bytes"])
    # A rank's own work: what its moves take, and to pack and unpack the borders.
    (grain, byte), *_ = np.linalg.lstsq(np.array([[one["grains_moved"], one["border_bytes"]] for one in said]),
                                        np.array([1e-3 * one["processor_ms"] for one in said]), rcond=None)
    height = alone["grains"] / (DENSITY * AREA)
    return {"move_seconds": grain * alone["grains_moved"] / alone["moves_made"], "border_seconds_per_byte": byte,
            "birth_seconds": 1e-6 * birth_us, "moves_per_grain": alone["moves_made"] / alone["grains"],
            "updates": between["border_calls"], "reductions": between["reductions_calls"],
            "bytes_per_border_grain": between["border_bytes"] / (2 * between["border_calls"] * DENSITY * AREA * EDGE),
            "bytes_per_shared_move": sum(between[f"{kind}_bytes"] for kind in KINDS[:3]) / (2 * REACH * alone["moves_made"] / height),
            "memory_per_grain": alone["memory"] / alone["grains"]}


def model(grains, ranks, inputs, blocks=False):
    """Seconds of a window by cause, in a cubic silo of so many grains that flows everywhere as the example's does. Slabs of layers,
    or blocks of the same volume in all three directions, which the program does not have."""
    side = (grains / DENSITY)**(1 / 3)
    layers = max(1, math.floor(side / EDGE))
    used = ranks if blocks else min(ranks, layers)
    stages, alone = math.log2(max(used, 1)), used == 1
    share = 1 / used if blocks else math.ceil(layers / used) / layers  # of the rank with the most layers
    edge = side / used**(1 / 3)
    shell = (lambda reach: (edge + 2 * reach)**3 - edge**3) if blocks else (lambda reach: 2 * reach * side**2)  # d^3
    neighbours = 26 if blocks else 2
    border = 0 if alone else inputs["updates"] * inputs["bytes_per_border_grain"] * DENSITY * shell(EDGE)  # bytes
    moves = grains * inputs["moves_per_grain"]
    shared = 0 if alone else inputs["bytes_per_shared_move"] * moves / grains * DENSITY * shell(REACH)
    table = 0 if alone else 4 * ranks * stages / 2  # bytes of the all-to-all exchange of lengths
    return {"moves": share * moves * inputs["move_seconds"],
            "borders": border * (inputs["border_seconds_per_byte"] + 1 / BANDWIDTH)
            + (not alone) * inputs["updates"] * neighbours * LATENCY,
            "exchanges": 3 * (stages * LATENCY + table / BANDWIDTH + (not alone) * neighbours * LATENCY) + shared / BANDWIDTH,
            "reductions": inputs["reductions"] * stages * LATENCY,
            "births": BIRTHS * side**2 / AREA * inputs["birth_seconds"]}


def predictions(inputs):
    """Rows for silos of up to 1e9 grains on up to 10,000 ranks."""
    rows = []
    for grains in (5.5e4, 1e6, 1e7, 1e8, 1e9):
        serial = sum(model(grains, 1, inputs).values())
        for ranks in (2, 10, 100, 1000, 10_000):
            slabs = model(grains, ranks, inputs)
            total = sum(slabs.values())
            rows.append({"study": "model", "case": f"{grains:.2g} grains", "grains": grains, "ranks": ranks,
                         "layers": math.floor((grains / DENSITY)**(1 / 3) / EDGE), "window_ms": 1e3 * total,
                         "speedup": serial / total, "efficiency": serial / total / ranks,
                         **{f"share_{cause}": value / total for cause, value in slabs.items()},
                         "efficiency_of_blocks": serial / sum(model(grains, ranks, inputs, blocks=True).values()) / ranks})
    return rows


# --- Report -----------------------------------------------------------------------------------------------------------

COLUMNS = {
    "strong": {"case": "28", "wall": "10.4g", "wall_least": "12.4g", "wall_most": "12.4g", "processor": "10.4g", "speedup": "9.2f",
               "same_dumps": "11", "others": "8.2f"},
    "weak": {"case": "28", "wall": "10.4g", "wall_least": "12.4g", "wall_most": "12.4g", "processor": "10.4g",
             "moves_per_second": "17.4g", "us_per_move_and_rank": "21.3g", "efficiency": "11.2f", "others": "8.2f"},
    "memory": {"case": "18", "grains": "10,d", "ranks": "6d", "memory_most": "12.0f", "memory_least": "13.0f", "memory_all": "11.0f"},
    "communication": {"ranks": "6d", "grains": "8.0f", "processor_ms": "13.3f", "processor_mean_ms": "18.3f", "memory": "10.3g",
                      "sweeps": "8.2f", "reductions_calls": "17.1f", "border_calls": "13.1f", "border_bytes": "13.0f",
                      "moves_messages": "15.1f", "moves_bytes": "12.0f", "shares_bytes": "13.0f", "weights_bytes": "14.0f", "migrants_bytes": "15.0f"},
    "model": {"grains": "9.2g", "layers": "7d", "ranks": "7d", "window_ms": "11.3g", "speedup": "9.3g", "efficiency": "11.3f",
              "share_moves": "12.2f", "share_borders": "14.2f", "share_exchanges": "16.2f", "share_reductions": "17.2f",
              "share_births": "13.2f", "efficiency_of_blocks": "21.3f"},
}


def table(study, rows):
    columns = COLUMNS[study]
    widths = {key: int(form.split(".")[0].rstrip(",dgf")) for key, form in columns.items()}
    lines = ["", study, "".join(key.rjust(width) for key, width in widths.items())]
    for row in rows:
        lines.append("".join(str(row[key]).rjust(widths[key]) if form.isdigit() else format(row[key], form)
                             for key, form in columns.items()))
    return "\n".join(lines)


def draw(path, rows):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    found = {study: [row for row in rows if row["study"] == study] for study in COLUMNS}
    figure, (speed, storage, traffic, future) = plt.subplots(1, 4, figsize=(20, 4.5), constrained_layout=True)
    speed.barh([row["case"] for row in found["strong"]], [row["speedup"] for row in found["strong"]])
    speed.set(xlabel="runs finished in the time of one run on 1 rank")
    for case in dict.fromkeys(row["case"] for row in found["memory"]):
        one = [row for row in found["memory"] if row["case"] == case]
        storage.plot([row["ranks"] for row in one], [row["memory_most"] for row in one], "o-", label=f"{case} ({one[0]['grains']:,})")
    storage.set(xlabel="ranks", ylabel="largest memory of a rank (MB)", xscale="log", yscale="log")
    for kind in KINDS:
        traffic.plot([row["ranks"] for row in found["communication"]], [row[f"{kind}_bytes"] for row in found["communication"]],
                     "o-", label=kind)
    traffic.set(xlabel="ranks", ylabel="bytes that a rank sends in a window, at most", xscale="log", yscale="symlog", ylim=(0, None))
    for case in dict.fromkeys(row["case"] for row in found["model"]):
        one = [row for row in found["model"] if row["case"] == case]
        line, = future.plot([row["ranks"] for row in one], [row["efficiency"] for row in one], "o-", label=case)
        future.plot([row["ranks"] for row in one], [row["efficiency_of_blocks"] for row in one], ":", color=line.get_color())
    future.set(xlabel="ranks", ylabel="efficiency, model; dotted: blocks", xscale="log")
    for axis in (storage, traffic, future):
        if axis.lines:
            axis.legend(fontsize=8)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def benchmark(options, work):
    rows, inputs = [], None
    for study in options.only:
        if study == "communication":
            birth, said = count_traffic(options)
            inputs = measured_inputs(birth, said)
            rows += communication(said) + predictions(inputs)
        else:
            rows += {"strong": strong, "weak": weak, "memory": memory}[study](options, work)
    print("Wall and processor s per simulated s, MB, bytes and calls of the busiest rank in a window")
    for study in COLUMNS:
        of_study = [row for row in rows if row["study"] == study]
        if of_study:
            print(table(study, of_study))
    if inputs:
        print("\ninputs of the model: " + ", ".join(f"{key} {value:.3g}" for key, value in inputs.items())
              + f", latency {LATENCY:g} s, bandwidth {BANDWIDTH:g} bytes/s")
    warn_of_others({row["case"]: row["others"] for row in rows if "others" in row})
    write_json(options.json, {"rows": rows, "inputs": inputs, "warm_up_tau": options.warm_up, "measure_tau": options.measure,
                              "seed": 1, "fix_options": options.fix, **provenance()})
    write_csv(options.csv, rows)
    if options.png:
        draw(options.png, rows)


def parse():
    parser = command_line(__doc__)
    add_table_options(parser, "case", "numbers")
    parser.add_argument("--only", nargs="+", choices=STUDIES, default=STUDIES, metavar="STUDY",
                        help=f"some of {', '.join(STUDIES)} (the model comes with the last)")
    parser.add_argument("--warm-up", type=number(float, 4), default=WARM_UP, metavar="TAU", help=f"flow before (default {WARM_UP})")
    parser.add_argument("--measure", type=number(float, 2), default=6, metavar="TAU", help="timed flow (default 6)")
    parser.add_argument("--repeats", type=number(int, 1), default=3, help="runs of each case (default 3)")
    parser.add_argument("--ranks", type=number(int, 1), nargs="+", default=[1, 2, 4, 8, 16, 32, 64], metavar="N",
                        help="numbers of ranks whose messages are counted, 1 among them (default 1 2 4 8 16 32 64)")
    parser.add_argument("--counter", default=str(ROOT / "build" / "bin" / "benchmark-communication"), type=program,
                        help="program that counts messages (default build/bin/benchmark-communication)")
    parser.add_argument("--fix", default="", metavar="'KEYWORD VALUE ...'", help="more words for fix spot, after those of the example")
    options = parser.parse_args()
    if not shutil.which("mpirun"):
        parser.error("no mpirun on the PATH")
    if 1 not in options.ranks or max(options.ranks) < 4:
        parser.error("--ranks: the model needs counts on 1 rank and on 4 or more")
    return options


if __name__ == "__main__":
    sys.exit(run(benchmark, parse()))
