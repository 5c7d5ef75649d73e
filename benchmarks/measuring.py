# SPDX-License-Identifier: GPL-2.0-or-later
"""What the benchmarks share: programs and their clocks, runs of the spot model, how good a packing is, command lines."""

import argparse
import contextlib
import csv
import ctypes
import datetime
import json
import math
import os
import pathlib
import shlex
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
sys.path.insert(0, str(ROOT / "analysis"))

from spot_analysis.base.interpreter import require_packages  # noqa: E402

require_packages("numpy", "scipy", "zstandard")

import numpy as np  # noqa: E402
from spot_analysis.base.errors import AnalysisError  # noqa: E402
from spot_analysis.reading.dump import read_frames  # noqa: E402
from spot_analysis.statistics import neighbours, packing, radial_distribution, run_statistics, structure  # noqa: E402
from spot_analysis.statistics.counts import FLUX_HEIGHTS  # noqa: E402
from spot_analysis.statistics.interval import Interval  # noqa: E402
from spot_analysis.statistics.interval_view import IntervalView  # noqa: E402
from spot_analysis.statistics.snapshot import TIME_TOLERANCE  # noqa: E402

DIAMETER, GRAVITY = 0.003, 9.81  # m, m/s2: of all decks
TAU = math.sqrt(DIAMETER / GRAVITY)  # s
SNAPSHOTS_APART = 2  # tau; as in the DEM reference
WARM_UP = 36  # tau; by then the first spots have come out at the top, and their number is steady
OTHERS_ALLOWED = 0.05  # processors busy with other programs, from which on a time is not to be trusted
# What the spot deck must not do while it is timed; benchmarks/in.spot takes their place.
OUTPUT_COMMANDS = {"dump", "dump_modify", "thermo", "thermo_style", "thermo_modify", "run", "restart", "print"}


class BenchmarkError(Exception):
    """What went wrong, in one line or with the end of a program's output."""


def say(text):
    print(text, file=sys.stderr, flush=True)


# --- Programs and the marks that they print ---------------------------------------------------------------------------

@dataclass(frozen=True)
class Mark:
    """A line "benchmark: mark STEP NAME VALUE ..." of a program, and the clocks (s) when it came: processor time of the
    program, of everything on this machine, and wall time."""

    step: int
    values: dict  # name -> float
    processor: float
    machine: float
    wall: float


@dataclass(frozen=True)
class Output:
    """sections : name -> marks, by the lines "benchmark: begin NAME"; notes : the words of all other "benchmark:" lines;
    memory : peak of each rank's resident memory, the largest first (MB); allocated : what LAMMPS says at the begin of each run (MB).
    """

    sections: dict
    notes: list
    memory: list
    allocated: list


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
            return int(line.split()[1]) * 1024 / 1e6
    return math.nan


def parallel(name, ranks):
    """The words that start a program on so many MPI ranks, more than there are processors if need be."""
    if ranks == 1:
        return [name]
    options = [*["--allow-run-as-root"][:os.geteuid() == 0], *["--oversubscribe"][:ranks > os.cpu_count()]]
    return ["mpirun", *options, "-np", ranks, name]


running = set()  # programs, for stop_programs()


def stop_programs():
    """After Ctrl-C no program may run on, whichever thread waits for it."""
    for process in list(running):
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGTERM)


def follow(name, command, folder, ranks=1):
    """Run a program to its end and take the time at each of its marks."""
    # A program that writes into a pipe keeps its lines back, and a mark must come when it is printed.
    command = ["stdbuf", "-oL", *map(str, command)]
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    sections, notes, allocated, tail, memory = {}, [], [], [], []
    process = subprocess.Popen(command, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                               text=True, errors="replace", start_new_session=True)
    running.add(process)
    try:
        for line in process.stdout:
            tail = [*tail[-14:], line.rstrip()]
            words = line.split()
            if line.startswith("Per MPI rank memory allocation"):
                allocated.append(float(words[-2]) * 1024**2 / 1e6)
            if words[:1] != ["benchmark:"]:
                continue
            if words[1] == "begin":
                marks = sections[words[2]] = []
                say(f"{name}: {words[2].replace('_', ' ')}")
            elif words[1] == "mark":
                wall, tree = time.monotonic(), process_tree(process.pid)
                values = dict(zip(words[3::2], map(float, words[4::2])))
                marks.append(Mark(int(words[2]), values, sum(map(processor_clock, tree)), machine_clock(), wall))
                memory = sorted(map(peak_memory, tree), reverse=True)[:ranks]  # launchers are smaller than ranks
            else:
                notes.append(words[1:])
    finally:
        # Reached early only by an exception, Ctrl-C among them.
        if process.poll() is None and sys.exc_info()[0]:
            os.killpg(process.pid, signal.SIGTERM)
        process.wait()
        running.discard(process)
    errors = [line for line in tail if line.startswith("ERROR")]
    if process.returncode or errors:
        raise BenchmarkError(f"{name}: {errors[0]}" if errors else
                             f"{name} failed (exit code {process.returncode}). The end of its output:\n  " + "\n  ".join(tail))
    return Output(sections, notes, memory, allocated)


def deck_variables(variables):
    return [str(word) for name, value in variables.items() for word in ("-var", name, value)]


# --- What a program costs ---------------------------------------------------------------------------------------------

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


def cost_of(repeats, timestep, memory):
    """repeats : for each the pairs of marks between which time is taken"""
    pairs = [pair for repeat in repeats for pair in repeat]
    for first, last in pairs:
        if last.step <= first.step:
            raise BenchmarkError(f"no step between the marks {first.step} and {last.step}")

    def total(repeat, clock):
        return sum(getattr(last, clock) - getattr(first, clock) for first, last in repeat)

    def per_second(clock):
        return [total(repeat, clock) / (total(repeat, "step") * timestep) for repeat in repeats]

    others = (total(pairs, "machine") - total(pairs, "processor")) / total(pairs, "wall")
    return Cost(timestep, total(repeats[0], "step"), per_second("processor"), per_second("wall"), max(others, 0.0), memory)


# --- The spot model ---------------------------------------------------------------------------------------------------

def spot_deck(words="", data=None, half_width=None, timestep=None, before_fix=(), restart=None):
    """The example's deck up to its output, with more words for fix spot, and benchmarks/in.spot after it.

    data : another packing; restart : a file to go on from, instead; half_width : of the silo along x (d); timestep : another one
    (tau); before_fix : commands to go there
    """
    commands = (EXAMPLE / "in.silo_spot").read_text().replace("&\n", " ").splitlines()
    commands = [command for command in commands if not _is_output(command)]
    place = _only([number for number, command in enumerate(commands) if command.split()[:1] == ["fix"]
                   and command.split()[3:4] == ["spot"]], "fix ID group spot")
    fix = f"{commands[place]} {words}".split()
    if half_width:
        walls = _only([number for number, word in enumerate(fix) if word == "box"], "box")
        fix[walls + 1:walls + 3] = [f"$(-{half_width}*v_d)", f"$({half_width}*v_d)"]
    commands[place] = " ".join(fix)
    if data or restart:
        read = _only([number for number, command in enumerate(commands) if command.split()[:1] == ["read_data"]], "read_data")
        commands[read] = f"read_restart {restart}" if restart else f"read_data {data}"
    commands[place:place] = before_fix
    if timestep:
        commands.append(f"timestep $({timestep}*v_tau)")
    return "\n".join([*commands, f"include {BENCHMARKS / 'in.spot'}", ""])


def _is_output(command):
    """Whether it is an output command, or an ``if`` that chooses among such."""
    words = shlex.split(command, comments=True)
    choices = [word.split() for word in words[1:]] if words[:1] == ["if"] else [words]
    return any(OUTPUT_COMMANDS & set(choice[:1]) for choice in choices)


def _only(found, what):
    if len(found) != 1:
        raise BenchmarkError(f"{EXAMPLE / 'in.silo_spot'}: {len(found)} times '{what}' where 1 was expected")
    return found[0]


@dataclass(frozen=True)
class SpotRun:
    """pairs : marks between which time is taken, from the step after a snapshot to the next snapshot
    interval : from the first snapshot to the last (tau); overlap : largest of any two grains at the snapshots (d)
    """

    folder: pathlib.Path
    pairs: list
    timestep: float  # s
    interval: tuple
    overlap: float
    memory_of_ranks: list  # MB
    allocated: list

    @property
    def memory(self):
        """MB"""
        return sum(self.memory_of_ranks)

    def cost(self):
        return cost_of([self.pairs], self.timestep, self.memory)

    def spots(self):
        """Alive, mean over the snapshots."""
        return statistics.fmean(last.values["spots"] for _, last in self.pairs)

    def rate(self, counter):
        """By how much a counter grew in a simulated second."""
        grown = sum(last.values[counter] - first.values[counter] for first, last in self.pairs)
        return grown / (sum(last.step - first.step for first, last in self.pairs) * self.timestep)


def run_spot(name, lmp, folder, deck, warm_up, measure, seed=1, apart=SNAPSHOTS_APART, dumps=True, ranks=1):
    """warm_up, measure, apart : tau; the first two are rounded up to whole intervals between snapshots, ``apart``."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "in.spot").write_text(deck)
    snapshots = math.ceil(measure / apart - 1e-9)
    variables = {"out": folder, "seed": seed, "warm_up": warm_up, "apart": apart, "snapshots": snapshots,
                 "dumps": "yes" if dumps else "no"}
    output = follow(name, [*parallel(lmp, ranks), "-in", folder / "in.spot", "-log", "none", *deck_variables(variables)],
                    EXAMPLE, ranks)
    said = {words[0]: words[1:] for words in output.notes}
    timestep, length = float(said["timestep"][0]), int(said["timestep"][2])  # "timestep TAU length STEPS"
    overlaps = [float(words[1]) for words in output.notes if words[0] == "overlap"]
    marks = {mark.step: mark for mark in output.sections["steady"]}
    end = max(marks)
    pairs = [(marks[end - (n + 1) * length + 1], marks[end - n * length]) for n in reversed(range(snapshots))]
    return SpotRun(folder, pairs, timestep * TAU, ((end - snapshots * length) * timestep, end * timestep), max(overlaps),
                   output.memory, output.allocated)


# --- How good the packing is ------------------------------------------------------------------------------------------

class Reference:
    """The stored DEM run, over an interval."""

    def __init__(self):
        self.run = run_statistics.load(EXAMPLE / "reference" / "dem-statistics.npz")

    def over(self, interval):
        """IntervalView over the snapshots in ``interval`` (tau), or over the two nearest."""
        times = self.run.times
        apart = np.abs(times - times.clip(*interval))
        kept = times[apart <= max(np.sort(apart)[1], TIME_TOLERANCE)]
        return IntervalView(self.run, np.arange(len(times)), Interval(kept[0], kept[-1], "chosen"))

    def rest(self):
        return radial_distribution.rdf(self.run, radial_distribution.columns(self.run)[0])


def quality(spot, reference):
    """Numbers of the snapshots of a SpotRun, and their errors against DEM in the same interval and region (analysis/README.md).

    rdf_rms : rms difference of g(r) beyond the contact peak; rdf_rms_relative : over DEM's own since the start
    flux_error : through each height, of DEM's through it; flux_over_outflow : of the spot model's own
    """
    dem, view = reference.run, reference.over(spot.interval)
    region, container = dem.region(), dem.scene.container()
    samples, sums = [], 0.0
    for frame in read_frames(str(spot.folder / "spot.*.dump")):
        positions = frame.positions / DIAMETER
        pairs = neighbours.region_pairs(positions, region)
        counts = radial_distribution.rdf_counts(pairs).reshape(-1, radial_distribution.REBIN).sum(axis=1)
        sums = sums + np.array([*counts, pairs.grains, 1.0])
        samples.append([structure.badness(pairs), structure.contacts_per_grain(pairs),
                        structure.packing_fraction(pairs.grains, region, container), len(positions),
                        *((positions[:, 2] > z).sum() for z in (0, *FLUX_HEIGHTS))])
    samples = np.array(samples)
    badness, contacts, fraction, grains = samples[:, :4].mean(axis=0)
    outflow, *fluxes = (samples[0, 4:] - samples[-1, 4:]) / (spot.interval[1] - spot.interval[0])
    badness_dem, fraction_dem, contacts_dem = (
        view.mean("1", values).value for values in (dem.badness, packing.fractions(dem), dem.contacts))
    fluxes_dem = [view.flux(z).value for z in FLUX_HEIGHTS]
    g, g_dem = radial_distribution.rdf(dem, sums), radial_distribution.mean_rdf(view)
    rms = float(radial_distribution.distance(dem, g, g_dem))
    return {
        "badness": float(badness), "badness_dem": badness_dem, "badness_ratio": float(badness) / badness_dem,
        "rdf_rms": rms, "rdf_rms_relative": rms / float(radial_distribution.distance(dem, reference.rest(), g_dem)),
        "packing_fraction": float(fraction), "packing_fraction_error": float(fraction) / fraction_dem - 1,
        "contacts": float(contacts), "contacts_error": float(contacts) / contacts_dem - 1,
        "outflow": float(outflow), "outflow_error": float(outflow) / view.flux(0).value - 1,
        "flux_error": {z: float(flux) / other - 1 for z, flux, other in zip(FLUX_HEIGHTS, fluxes, fluxes_dem)},
        "flux_over_outflow": {z: float(flux / outflow) if outflow else math.nan for z, flux in zip(FLUX_HEIGHTS, fluxes)},
        "largest_overlap": spot.overlap, "grains": float(grains), "snapshots": len(samples), "snapshots_dem": len(view.snapshots),
    }


# --- Reports and command lines ----------------------------------------------------------------------------------------

def provenance():
    """Where and with what numbers were measured; the commit has a plus sign where files differ from it."""
    with open("/proc/cpuinfo", encoding="utf-8") as lines:
        models = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]

    def git(*words):
        return subprocess.run(["git", "-C", str(ROOT), *words], capture_output=True, text=True, check=True).stdout.strip()
    try:
        commit = git("rev-parse", "HEAD") + ("+" if git("status", "--porcelain") else "")
    except (OSError, subprocess.CalledProcessError):
        commit = "unknown"
    return {"machine": {"model": models[0] if models else "unknown", "processors": os.cpu_count()}, "commit": commit,
            "date": datetime.datetime.now().astimezone().isoformat(timespec="seconds")}


def warn_of_others(costs):
    """costs : name -> processors that others kept busy"""
    busy = [name for name, others in costs.items() if others > OTHERS_ALLOWED]
    if busy:
        say(f"warning: other programs were running beside {', '.join(busy)}: these times are too high")


def write_json(path, result):
    if path:
        path.write_text(json.dumps(result, indent=2) + "\n")


def write_csv(path, rows):
    """A column for every key of any row, apart from those of lists."""
    if not path:
        return
    columns = dict.fromkeys(key for row in rows for key, value in row.items() if not isinstance(value, (list, tuple, dict)))
    with open(path, "w", newline="", encoding="utf-8") as out:
        writer = csv.DictWriter(out, columns, extrasaction="ignore")
        writer.writeheader()
        writer.writerows(rows)


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
        raise argparse.ArgumentTypeError(f"no program '{word}'; build the project or name one")
    return os.path.abspath(found)


def output_file(word):
    path = pathlib.Path(word)
    if not path.absolute().parent.is_dir():
        raise argparse.ArgumentTypeError(f"no folder {path.absolute().parent}")  # not after ten minutes
    return path


def command_line(description):
    """A parser with the options that all benchmarks have."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", metavar="FILE", type=output_file, help="write all numbers there too")
    parser.add_argument("--lmp", default=str(ROOT / "build" / "bin" / "lmp"), type=program,
                        help="lmp with fix spot (default build/bin/lmp)")
    parser.add_argument("--keep", metavar="DIR", type=pathlib.Path, help="keep decks and snapshots in this new or empty folder")
    return parser


def add_table_options(parser, row, picture):
    """For benchmarks that end with a table, each of whose rows is a `row`, and draw it as a `picture`."""
    parser.add_argument("--csv", metavar="FILE", type=output_file, help=f"write one row a {row} there")
    parser.add_argument("--png", metavar="FILE", type=output_file, help=f"draw the {picture} there")


def run(benchmark, options):
    """Call benchmark(options, folder) with a scratch folder; errors become one line."""
    # As Ctrl-C: no program may run on, and the folder must go.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    with contextlib.ExitStack() as stack:
        if options.keep:
            work = options.keep.absolute()
            if work.exists() and (not work.is_dir() or any(work.iterdir())):
                sys.exit(f"error: --keep: {options.keep} is not an empty folder")
            work.mkdir(parents=True, exist_ok=True)
        else:
            work = pathlib.Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="benchmark.")))
        try:
            benchmark(options, work)
        except (BenchmarkError, AnalysisError, OSError) as error:
            sys.exit(f"error: {error}")
        except KeyboardInterrupt:
            stop_programs()
            sys.exit("interrupted")
