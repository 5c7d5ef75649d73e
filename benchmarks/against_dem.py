#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Time the spot model against DEM (LIGGGHTS and LAMMPS) in the steady drainage of the silo of examples/silo, in one session.

Processor time and wall time per simulated second of flow; start-up, warm-up and snapshots are left out. See README.md.
"""

import argparse
import contextlib
import ctypes
import datetime
import gzip
import json
import math
import os
import pathlib
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass

ROOT = pathlib.Path(__file__).resolve().parents[1]
BENCHMARKS = ROOT / "benchmarks"
EXAMPLE = ROOT / "examples" / "silo"
DEM_DECKS = ROOT / "liggghts-inputs" / "silo"
sys.path.insert(0, str(ROOT / "analysis"))

from spot_analysis.interpreter import require_packages  # noqa: E402

require_packages("numpy", "scipy")

from spot_analysis import run_statistics, structure  # noqa: E402
from spot_analysis.dump import read_frames  # noqa: E402
from spot_analysis.errors import AnalysisError  # noqa: E402

DIAMETER, GRAVITY = 0.003, 9.81  # m, m/s2: of all three decks
TAU = math.sqrt(DIAMETER / GRAVITY)  # s
PAPER_STEP = 1e-4  # tau
OTHERS_ALLOWED = 0.05  # processors busy with other programs, from which on a time is not to be trusted
# What the spot deck must not do while it is timed; benchmarks/in.spot takes their place.
OUTPUT_COMMANDS = {"dump", "dump_modify", "thermo", "thermo_style", "thermo_modify", "run", "restart", "print"}


class BenchmarkError(Exception):
    """What went wrong, in one line or with the end of a program's output."""


# --- Programs and the marks that they print ---------------------------------------------------------------------------

@dataclass(frozen=True)
class Mark:
    """A line "benchmark: mark STEP ..." of a program, and the clocks (s) when it came: processor time of the program, of
    everything on this machine, and wall time."""

    step: int
    words: tuple
    processor: float
    machine: float
    wall: float


@dataclass(frozen=True)
class Output:
    """sections : name -> marks, by the lines "benchmark: begin NAME"; notes : the words of all other "benchmark:" lines;
    memory : largest resident memory, all ranks together (MB)."""

    sections: dict
    notes: list
    memory: float


def processor_clock(pid):
    """Processor time of all threads of a running process, user and system (s)."""
    clock = ctypes.c_int()
    if ctypes.CDLL(None).clock_getcpuclockid(pid, ctypes.byref(clock)):
        raise BenchmarkError(f"process {pid} has no processor clock")
    return time.clock_gettime(clock.value)


def machine_clock():
    """Processor time of all processes since the machine started (s)."""
    # cpu user nice system idle iowait irq softirq steal ...
    ticks = list(map(int, pathlib.Path("/proc/stat").read_text().split("\n", 1)[0].split()[1:9]))
    return (sum(ticks) - ticks[3] - ticks[4]) / os.sysconf("SC_CLK_TCK")


def process_tree(pid):
    """``pid`` and all below it: the ranks of mpirun, and the idle helper that Open MPI starts even for a single rank."""
    children = pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    return [pid, *(process for child in children for process in process_tree(int(child)))]


def peak_memory(pid):
    """MB"""
    for line in pathlib.Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("VmHWM"):
            return int(line.split()[1]) / 1000
    return math.nan


def follow(name, command, folder, ranks=1):
    """Run a program to its end and take the time at each of its marks."""
    # A program that writes into a pipe keeps its lines back, and a mark must come when it is printed.
    command = ["stdbuf", "-oL", *map(str, command)]
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    sections, notes, tail, memory = {}, [], [], math.nan
    process = subprocess.Popen(command, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                               text=True, errors="replace", start_new_session=True)
    try:
        for line in process.stdout:
            tail = [*tail[-14:], line.rstrip()]
            words = line.split()
            if words[:1] != ["benchmark:"]:
                continue
            if words[1] == "begin":
                marks = sections[words[2]] = []
                print(f"{name}: {words[2].replace('_', ' ')}", file=sys.stderr, flush=True)
            elif words[1] == "mark":
                wall, tree = time.monotonic(), process_tree(process.pid)
                marks.append(Mark(int(words[2]), tuple(words[3:]), sum(map(processor_clock, tree)), machine_clock(), wall))
                memory = sum(sorted(map(peak_memory, tree))[-ranks:])  # launchers are smaller than ranks
            else:
                notes.append(words[1:])
    finally:
        # Reached early only by an exception, Ctrl-C among them: no rank may run on.
        if process.poll() is None and sys.exc_info()[0]:
            os.killpg(process.pid, signal.SIGTERM)
        process.wait()
    if process.returncode or any(line.startswith("ERROR") for line in tail):
        raise BenchmarkError(f"{name} failed (exit code {process.returncode}). The end of its output:\n  " + "\n  ".join(tail))
    return Output(sections, notes, memory)


def parallel(program, cores):
    if cores == 1:
        return [program]
    options = ["--allow-run-as-root"] if os.geteuid() == 0 else []
    return ["mpirun", *options, "-np", cores, program]


# --- What one program costs -------------------------------------------------------------------------------------------

@dataclass(frozen=True)
class Cost:
    """Processor and wall seconds per simulated second, one value a repeat.

    others : processors that other programs kept busy meanwhile; they slow this one down, by memory and caches at least
    """

    timestep: float  # s
    steps: int  # in a repeat
    processor: list
    wall: list
    others: float
    memory: float  # MB

    def summary(self):
        return {"timestep_tau": self.timestep / TAU, "steps_per_repeat": self.steps,
                "processor_seconds_per_second": spread(self.processor),
                "wall_seconds_per_second": spread(self.wall),
                "core_milliseconds_per_step": statistics.median(self.processor) * self.timestep * 1000,
                "processors_busy_with_others": self.others, "memory_megabytes": self.memory}


def spread(values):
    return {"median": statistics.median(values), "min": min(values), "max": max(values), "values": values}


def ratio(dem, spot):
    """Of the medians; and its extremes, one program at its fastest, the other at its slowest."""
    return {"median": statistics.median(dem) / statistics.median(spot), "min": min(dem) / max(spot),
            "max": max(dem) / min(spot)}


def cost_of(intervals, timestep, memory):
    """intervals : pairs of marks"""
    for first, last in intervals:
        if last.step <= first.step:
            raise BenchmarkError(f"no step between the marks {first.step} and {last.step}")
    seconds = [(last.step - first.step) * timestep for first, last in intervals]
    begin, end = intervals[0][0], intervals[-1][1]
    others = ((end.machine - begin.machine) - (end.processor - begin.processor)) / (end.wall - begin.wall)
    return Cost(timestep, intervals[0][1].step - begin.step,
                [(last.processor - first.processor) / s for (first, last), s in zip(intervals, seconds)],
                [(last.wall - first.wall) / s for (first, last), s in zip(intervals, seconds)], max(others, 0.0), memory)


def dem_cost(output, section, timestep, repeats):
    """Of the last ``repeats`` stretches: the one before them holds what a new run does first."""
    marks = output.sections.get(section, [])[-repeats - 1:]
    if len(marks) != repeats + 1:
        raise BenchmarkError(f"{len(marks)} marks in '{section}' where {repeats + 1} are needed")
    return cost_of(list(zip(marks, marks[1:])), timestep, output.memory)


def time_liggghts(options, work):
    """Costs at the paper's time step and at twice it; leaves the packing and the constants for in.lammps in ``work``."""
    with gzip.open(BENCHMARKS / "flowing.data.gz") as packed, open(work / "flowing.data", "wb") as plain:
        shutil.copyfileobj(packed, plain)
    warm_up = math.ceil(options.dem_warm_up / (2 * PAPER_STEP))
    variables = {"size": "paper", "out": work, "data": work / "flowing.data", "warm_up": warm_up,
                 "stretch": options.steps, "stretches": options.repeats + 1}
    output = follow("LIGGGHTS", [*parallel(options.liggghts, options.cores), "-in", BENCHMARKS / "in.liggghts",
                                 "-log", "none", *deck_variables(variables)], DEM_DECKS, options.cores)
    step = PAPER_STEP * TAU
    return (dem_cost(output, "paper_step", step, options.repeats),
            dem_cost(output, "double_step", 2 * step, options.repeats))


def time_lammps(options, work):
    variables = {"stretch": options.steps, "stretches": options.repeats + 1}
    output = follow("LAMMPS gran/hertz/history",
                    [*parallel(options.lammps, options.cores), "-in", BENCHMARKS / "in.lammps", "-log", "none",
                     *deck_variables(variables)], work, options.cores)
    return dem_cost(output, "paper_step", PAPER_STEP * TAU, options.repeats)


def deck_variables(variables):
    return [str(word) for name, value in variables.items() for word in ("-var", name, value)]


def spot_deck(fix_options):
    """The example's deck up to its output, with more words for fix spot, and benchmarks/in.spot after it."""
    commands = (EXAMPLE / "in.silo_spot").read_text().replace("&\n", " ").splitlines()
    commands = [command for command in commands if not OUTPUT_COMMANDS & set(command.split()[:1])]
    fixes = [place for place, command in enumerate(commands) if command.split()[:1] == ["fix"] and command.split()[3] == "spot"]
    if len(fixes) != 1:
        raise BenchmarkError(f"{EXAMPLE / 'in.silo_spot'}: {len(fixes)} commands 'fix ID group spot' where 1 was expected")
    commands[fixes[0]] += " " + fix_options
    return "\n".join([*commands, f"include {BENCHMARKS / 'in.spot'}", ""])


def time_spot(options, work):
    """Cost, the interval that was timed (tau), and the spots alive and their moves per second in it.

    Leaves the snapshots in ``work``.
    """
    deck = work / "in.spot"
    deck.write_text(spot_deck(options.fix))
    variables = {"out": work, "warm_up": options.warm_up, "stretch": options.measure, "stretches": options.repeats}
    output = follow("spot model", [options.lmp, "-in", deck, "-log", "none", *deck_variables(variables)], EXAMPLE)
    # "timestep DT length STEPS": DT in tau
    [(_, timestep, _, length)] = output.notes
    timestep, length = float(timestep), int(length)
    marks = {mark.step: mark for mark in output.sections["steady"]}
    end = max(marks)
    start = end - options.repeats * length
    intervals = [(marks[end - (n + 1) * length + 1], marks[end - n * length]) for n in reversed(range(options.repeats))]
    cost = cost_of(intervals, timestep * TAU, output.memory)
    moves = (int(float(marks[end].words[1])) - int(float(marks[start].words[1]))) / ((end - start) * timestep * TAU)
    return cost, (start * timestep, end * timestep), {"spots": float(marks[end].words[0]), "moves_per_second": moves}


# --- How good the packing is ------------------------------------------------------------------------------------------

def compare_badness(interval, work):
    """B of the snapshots of both in the region of the analysis: the spot model's at the ends of its stretches, DEM's stored ones
    of the same interval, or the nearest."""
    dem = run_statistics.load(EXAMPLE / "reference" / "dem-statistics.npz")
    region = dem.region()
    spot = [structure.badness(structure.region_pairs(frame.positions / DIAMETER, region))
            for frame in read_frames(str(work / "spot.*.dump"))]
    apart = abs(dem.times - dem.times.clip(*interval))
    stored = dem.badness[apart <= max(apart.min(), run_statistics.TIME_TOLERANCE)]
    return {"spot": float(statistics.fmean(spot)), "spot_snapshots": len(spot),
            "dem": float(stored.mean()), "dem_snapshots": len(stored)}


# --- Report -----------------------------------------------------------------------------------------------------------

def machine():
    with open("/proc/cpuinfo", encoding="utf-8") as lines:
        models = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return {"model": models[0] if models else "unknown", "processors": os.cpu_count()}


def commit():
    """Of the repository, with a plus sign where files differ from it."""
    def git(*words):
        return subprocess.run(["git", "-C", str(ROOT), *words], capture_output=True, text=True, check=True).stdout.strip()
    try:
        return git("rev-parse", "HEAD") + ("+" if git("status", "--porcelain") else "")
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


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
    date = datetime.datetime.now().astimezone().isoformat(timespec="seconds")
    spot, interval, flow = time_spot(options, work)
    badness = compare_badness(interval, work)
    paper, double = time_liggghts(options, work)
    lammps = time_lammps(options, work)

    names = {"liggghts": ("LIGGGHTS", paper), "liggghts_double_step": ("LIGGGHTS, twice the time step", double),
             "lammps": ("LAMMPS gran/hertz/history", lammps)}
    ratios = {key: ratio(cost.processor, spot.processor) for key, (_, cost) in names.items()}
    result = {
        **{f"ratio_{key}": value["median"] for key, value in ratios.items()},
        "badness_ratio": badness["spot"] / badness["dem"],
        "cores": options.cores, "repeats": options.repeats,
        "ratios": ratios, "badness": badness,
        "programs": {"spot": {**spot.summary(), **flow}, **{key: cost.summary() for key, (_, cost) in names.items()}},
        "interval": {"spot_tau": interval, "dem_warm_up_tau": options.dem_warm_up, "dem_steps": options.steps},
        "fix_options": options.fix, "machine": machine(), "commit": commit(), "date": date,
    }
    print(table({**dict(names.values()), "spot model": spot},
                {name: ratios[key] for key, (name, _) in names.items()}))
    print(f"B: spot {badness['spot']:.3g}, DEM {badness['dem']:.3g}, ratio {result['badness_ratio']:.3g} "
          f"({interval[0]:g} to {interval[1]:g} tau); {options.cores} core(s) for DEM, {options.repeats} repeats")
    busy = [name for name, cost in [*names.values(), ("spot model", spot)] if cost.others > OTHERS_ALLOWED]
    if busy:
        print(f"warning: other programs were running beside {', '.join(busy)}: these times are too high", file=sys.stderr)
    return result


# --- Command line -----------------------------------------------------------------------------------------------------

def number(kind, least):
    def read(word):
        try:
            value = kind(word)
        except ValueError:
            value = None
        if value is None or not least <= value < math.inf:
            raise argparse.ArgumentTypeError(f"'{word}' must be {'a whole number' if kind is int else 'a number'}, {least} or more")
        return value
    return read


def program(word):
    """Absolute, since every deck runs in a folder of its own."""
    found = shutil.which(word)
    if not found:
        raise argparse.ArgumentTypeError(f"no program '{word}'")
    return os.path.abspath(found)


def parse(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", metavar="FILE", type=pathlib.Path, help="write all numbers there too")
    parser.add_argument("--cores", type=number(int, 1), default=1, help="MPI ranks of both DEM programs (default 1)")
    parser.add_argument("--repeats", type=number(int, 1), default=3, help="timed stretches of each program (default 3)")
    parser.add_argument("--steps", type=number(int, 1), default=1500, help="DEM steps in a stretch (default 1500)")
    parser.add_argument("--dem-warm-up", type=number(float, 0.01), default=0.5, metavar="TAU",
                        help="DEM flow before the first stretch, at twice the time step (default 0.5)")
    parser.add_argument("--measure", type=number(float, 0.2), default=3, metavar="TAU",
                        help="length of a stretch of the spot model (default 3)")
    parser.add_argument("--warm-up", type=number(float, 0), default=35, metavar="TAU",
                        help="spot flow before the first stretch (default 35, when the number of spots is steady)")
    parser.add_argument("--fix", default="", metavar="'KEYWORD VALUE ...'", help="more words for fix spot, after those of the example")
    parser.add_argument("--lmp", default=str(ROOT / "build" / "bin" / "lmp"), help="lmp with fix spot (default build/bin/lmp)")
    parser.add_argument("--lammps", default="lmp", help="LAMMPS with gran/hertz/history (default the lmp on the PATH)")
    parser.add_argument("--liggghts", default="liggghts", help="LIGGGHTS (default the one on the PATH)")
    parser.add_argument("--keep", metavar="DIR", type=pathlib.Path, help="keep decks and snapshots in this new or empty folder")
    options = parser.parse_args(arguments)
    for name in ("lmp", "lammps", "liggghts"):
        try:
            setattr(options, name, program(getattr(options, name)))
        except argparse.ArgumentTypeError as error:
            parser.error(f"--{name}: {error}; build the project or name one with --{name}")
    if options.cores > os.cpu_count():
        parser.error(f"--cores: {options.cores} asked, this machine has {os.cpu_count()}")
    if options.cores > 1 and not shutil.which("mpirun"):
        parser.error("--cores: no mpirun on the PATH")
    if options.json and not options.json.absolute().parent.is_dir():
        parser.error(f"--json: no folder {options.json.absolute().parent}")  # not after ten minutes
    if options.keep and options.keep.exists() and (not options.keep.is_dir() or any(options.keep.iterdir())):
        parser.error(f"--keep: {options.keep} is not an empty folder")
    return options


def main():
    options = parse(None)
    # As Ctrl-C: no program may run on, and the folder must go.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    with contextlib.ExitStack() as stack:
        if options.keep:
            work = options.keep.absolute()
            work.mkdir(parents=True, exist_ok=True)
        else:
            work = pathlib.Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="against_dem.")))
        try:
            result = benchmark(options, work)
            if options.json:
                options.json.write_text(json.dumps(result, indent=2) + "\n")
        except (BenchmarkError, AnalysisError, OSError) as error:
            sys.exit(f"error: {error}")
        except KeyboardInterrupt:
            sys.exit("interrupted")


if __name__ == "__main__":
    main()
