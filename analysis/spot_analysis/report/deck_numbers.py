# SPDX-License-Identifier: GPL-2.0-or-later
"""What follows from a dry run of a deck: numbers, and what was calibrated on DEM or compared with it.

Ranges of parameters span the calibrations in analysis/README.md, those of 2006 included; those of outlet and sizes, what
was compared.
"""

import math

from ..base.errors import AnalysisError
from .deck_rows import Row, closures, is_mixture, outlet, sizes

GRAVITY = {"si": 9.81, "cgs": 981.0, "lj": 1.0}  # by units of LAMMPS
MOVE = 8e-6  # s of one core, on a quiet machine: examples/silo and own-hopper, 28 and 16 to 17 s for a simulated second
SPOT_BYTES = 144  # of one live spot: its state, 88, and its row of output, 56
CALIBRATED = "calibrations for glass beads"


def tau_of(run, gravity=None):
    """sqrt(d / g) in the deck's unit of time; raises AnalysisError where g is not known."""
    gravity = gravity or GRAVITY.get(run["units"])
    if not gravity or not gravity > 0 or not math.isfinite(gravity):
        raise AnalysisError(f"--g: give gravity's acceleration, a positive number in the deck's units ({run['units']})")
    return math.sqrt(run["diameter"] / gravity)


def numbers(run, tau):
    """Rows on a dry run, as of its JSON."""
    d, seconds = run["diameter"], run["units"] in ("si", "cgs")
    time = "s" if seconds else "time"
    grain = math.pi / 6 * d**3
    outflow = sum(one["outflow"] for one in run["outlets"])
    end = run["steps"] * run["timestep"]
    parabolic = run["profile"] == "parabolic"
    rows = [
        Row("grains", run["grains"], "", None, 3e7, "what a restart file holds"),
        Row("diameter d", d, "length"),
        Row("tau = sqrt(d/g)", tau, time),
        *sizes(run, d),
        outlet(min(2 * min(one["half_widths"]) / d for one in run["outlets"])),
        Row("radius of spots R_s", run["radius"] / d, "d", *((3.4, 4.1) if parabolic else (2.5, 3.03)), CALIBRATED),
        Row("volume of a spot V_s", run["spot_volume"] / grain, "grains", 0.1, 0.21, CALIBRATED),
        Row("grains in a spot", run["enclosed"] / grain, "", None, None, "at a packing fraction of 0.58"),
        Row("diffusion length b_s", run["diffusion"] / d, "d", 1.1, 1.6, CALIBRATED),
        Row("speed v_s", run["speed"] * tau / d, "d/tau", 4, 10, CALIBRATED + "; else g or the units are others"),
        *closures(run, d),
        Row("dilation c_0", run["dilation"], "", 0, 0, "0: all spots climb at v_s"),
        Row("outflow", outflow, f"grains/{time}", None, None, "births x V_s; with *injection* 2 to 6 % less leave"),
        Row("outflow", outflow * tau, "grains/tau", None, None, "an input: nothing here checks it"),
        *[Row(f"  through outlet {k}", one["outflow"] * tau, "grains/tau") for k, one in enumerate(run["outlets"], 1)
          if len(run["outlets"]) > 1],
        _emptied(run, outflow * tau),
        Row("length of the run", end / tau, "tau", None, None, f"{run['steps']} steps of {run['timestep'] / tau:.3g} tau"),
        Row("window", run["window"] / tau, "tau", None, None, f"{round(run['timestep'] / run['window'])} in a step"),
        Row("climb of a spot in it", run["speed"] * run["window"] / d, "d", *((0.01, 0.8) if not run["time_ordered"] else (None, None)),
            "0.6 or less if the fix chooses it"),
        Row("spots alive", run["spots"], "", None, None, "steady flow, full silo" + ("" if run["steady"] else "; still changing")),
        Row("moves", run["moves_per_time"] * tau, "1/tau", None, None, "then"),
        Row("memory", (run["memory"] + SPOT_BYTES * run["spots"]) / 1e6, "MB", None, None, "estimate, of the fix"),
    ]
    return rows + ([] if run["time_ordered"] else _cost(run, end, seconds))


def _emptied(run, outflow):
    """outflow : grains a tau"""
    taken = run["grains"] / outflow
    if run.get("recirculates"):  # which older programs don't tell
        return Row("turned over every", taken, "tau", None, None, "what leaves comes in again")
    return Row("empty after", taken, "tau", None, None, "at this outflow")


def _cost(run, end, seconds):
    """Processor time, where a move costs about the same: not in the order of time."""
    per_time = MOVE * run["moves_per_time"]
    found = [Row("processor time", per_time, "s/s", None, None, "estimate, a simulated second of a full silo")] if seconds else []
    less = "" if run.get("recirculates") else "; less as the silo empties"
    less += "; sizes cost up to 2.6 times as much" if is_mixture(run) else ""
    return found + [Row("processor time", per_time * end, "s", None, None, "estimate, the run" + less)]


def table(rows):
    """The rows as text in aligned columns; what is outside its range is marked."""
    cells = [("", "number", "value", "unit", "range", "note")]
    for row in rows:
        low, high = ("" if bound is None else f"{bound:g}" for bound in (row.low, row.high))
        span = f"{low} to {high}" if low and high else f"up to {high}" if high else f"from {low}" if low else ""
        cells.append(("!" if row.fits is False else "", row.name, _text(row.value), row.unit, span, row.note))
    widths = [max(len(line[column]) for line in cells) for column in range(len(cells[0]))]
    lines = [f"{line[0]:1} " + "  ".join(text.ljust(width) for text, width in zip(line[1:], widths[1:])).rstrip() for line in cells]
    outside = [row.name for row in rows if row.fits is False]
    return "\n".join(lines + [f"outside what was calibrated on DEM or compared with it: {', '.join(outside)}"] * bool(outside))


def _text(value):
    return f"{value:d}" if isinstance(value, int) else f"{value:.4g}"
