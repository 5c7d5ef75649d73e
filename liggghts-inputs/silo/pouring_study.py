#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""How dense a poured bed gets, against the flux and the speed of the grains that arrive, in a narrow piece of the paper's silo.

Runs in.pour with 4,000 grains in a silo 16 d wide and 8 d deep (a bed of 27 d) once for each case, and measures the packing fraction
in 8 d < z < 20 d, away from the base and the surface. A case is FLUX:SPEED[:SEED[:STEP]]: grains per tau and d^2 of cross-section;
downward speed with which they arrive at z = 14 d, in sqrt(g d); seed; time step in 1e-4 tau. Without cases: the table of README.md.
A case whose packing is in the output folder is not run again. The environment variable LIGGGHTS names another program than liggghts.
"""

import argparse
import math
import os
import pathlib
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
DIAMETER = 3e-3
TAU = math.sqrt(DIAMETER / 9.81)
WIDTH, DEPTH = 16, 8
SLAB = 8, 20
POUR_HEIGHT = 45
# in.pour's layer is 10 d thick; from its middle to the middle of the slab
FALL = POUR_HEIGHT - 5 - sum(SLAB) / 2
SEEDS = 15485863, 32452867
CASES = [f"{flux}:{speed}:{seed}" for flux, speed in ((2.75, 12), (2.75, 17.3), (1.375, 17.3), (0.6875, 17.3), (0.6875, 25))
         for seed in SEEDS] + ["2.75:25", "1.09:28", "0.6875:12", "0.55:17.3", "0.34375:17.3", f"0.6875:17.3:{SEEDS[0]}:1"]


def parse(case):
    words = case.split(":")
    try:
        flux, speed = float(words[0]), float(words[1])
        seed = int(words[2]) if len(words) > 2 else SEEDS[0]
        step = float(words[3]) if len(words) > 3 else 2.0
    except (ValueError, IndexError):
        sys.exit(f"ERROR: '{case}' is not FLUX:SPEED[:SEED[:STEP]]")
    if speed**2 <= 2 * FALL:
        sys.exit(f"ERROR: the fall alone gives {math.sqrt(2 * FALL):.1f} sqrt(g d), more than the {speed:g} of '{case}'")
    return flux, speed, seed, step


def pour(flux, speed, seed, step, out):
    variables = {"size": "small", "grains": 4000, "half_width": WIDTH / 2, "half_depth": DEPTH / 2, "pour_height": POUR_HEIGHT,
                 "pour_speed": f"{math.sqrt(speed**2 - 2 * FALL):.4f}", "flux": f"{flux * WIDTH * DEPTH / TAU:.6g}",
                 "seed": seed, "step": f"{step:g}", "out": out,
                 "rest": 0.02}  # the last grains that still bounce on the surface do not matter here
    command = [os.environ.get("LIGGGHTS", "liggghts"), "-in", "in.pour", "-log", "none"]
    for name, value in variables.items():
        command += ["-var", name, str(value)]
    done = subprocess.run(command, cwd=HERE, capture_output=True, text=True, errors="replace")
    if done.returncode != 0:
        sys.exit(f"ERROR: in.pour failed in {out}:\n{done.stdout[-1000:]}{done.stderr[-1000:]}")


def share_below(height):
    """Share of a sphere's volume that lies below a plane at `height` diameters above its centre."""
    depth = min(max(height + 0.5, 0), 1)
    return depth**2 * (3 - 2 * depth)


def packing_fraction(dump):
    low, high = SLAB
    heights = [float(line.split()[4]) / DIAMETER for line in dump.read_text(encoding="ascii").splitlines()[9:]]
    spheres = sum(share_below(high - z) - share_below(low - z) for z in heights)
    return spheres * math.pi / 6 / (WIDTH * DEPTH * (high - low))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=HERE / "post/pouring_study", help="folder of the runs (%(default)s)")
    parser.add_argument("cases", nargs="*", default=CASES, metavar="CASE")
    args = parser.parse_args()

    print("  flux  speed      seed  step  fraction  seconds", flush=True)
    for flux, speed, seed, step in [parse(case) for case in args.cases]:
        out = args.out.resolve() / f"{flux:g}_{speed:g}_{seed}_{step:g}"
        dump = out / "pour/packed.dump"
        started = time.monotonic()
        if not dump.exists():
            pour(flux, speed, seed, step, out)
        print(f"{flux:6.3f} {speed:6.1f} {seed:9d} {step:5g} {packing_fraction(dump):9.4f} {time.monotonic() - started:8.0f}", flush=True)


if __name__ == "__main__":
    main()
