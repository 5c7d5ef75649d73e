#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Dumps of two baselines that the spot model must beat, made from a packing: nothing changes, or grains follow the kinematic
model's Gaussian."""

import argparse
import json
import math
import os

from spot_analysis.base.interpreter import require_packages

require_packages("numpy", "scipy", "matplotlib", "zstandard")

import numpy as np  # noqa: E402  (only after the check above)

from spot_analysis.base.errors import AnalysisError  # noqa: E402
from spot_analysis.commands import command_line  # noqa: E402
from spot_analysis.reading.dump import read_frames  # noqa: E402
from spot_analysis.reading.json_object import FORMAT  # noqa: E402
from spot_analysis.reading.scene import PERIOD_KEY  # noqa: E402
from spot_analysis.statistics.snapshot import LAG_TAU  # noqa: E402

STEP = 0.05  # tau; below the time in which a grain at the orifice falls by a tenth of a diameter
TIMESTEP = 1e-4  # tau, of one step of TIMESTEP in the dumps, as in the DEM reference
OUTLET = -2.0  # d, where grains are taken out
DIFFUSION = 1.15  # d; b, half the slope of the variance of DEM's v_z profile
START = 2.0  # d^2; variance of the profile at z = 0


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("model", choices=("nothing", "kinematic"))
    parser.add_argument("packing", metavar="DUMP", help="the packing at rest; its scene.json or --scene tells the units")
    parser.add_argument("-o", "--output", required=True, metavar="FOLDER", help="for dumps and scene.json, in d and tau")
    parser.add_argument("--time", type=float, default=90.0, metavar="TAU", help="(default: %(default)g tau)")
    parser.add_argument("--outflow", type=float, default=69.6, metavar="F", help="grains a tau (default: that of DEM)")
    parser.add_argument("--diffusion", type=float, default=DIFFUSION, metavar="B",
                        help="length b, d (default: %(default)g, half the slope of the variance of DEM's v_z profile)")
    parser.add_argument("--start", type=float, default=START, metavar="D2",
                        help="variance of the profile at z = 0, d^2 (default: %(default)g)")
    command_line.add_scene_options(parser)
    return parser.parse_args()


def kinematic_velocity(positions, flux, diffusion, start):
    """u (n, 3) where v_z spreads as a Gaussian (Nedderman, Tuzun 1979): u_x = -b dv_z/dx, which closes the volume.

    positions : (n, 3) d; flux : volume a tau over the depth, d^2/tau; diffusion : b, d; start : variance at z = 0, d^2
    """
    x, _, z = positions.T
    variance = np.maximum(start + 2 * diffusion * z, start)
    down = flux * np.exp(-x**2 / (2 * variance)) / np.sqrt(2 * np.pi * variance)
    return np.column_stack([-diffusion * np.where(z > 0, x / variance, 0) * down, 0 * x, -down])


def follow(positions, duration, velocity):
    """Where grains are after ``duration`` tau, by the midpoint rule."""
    for _ in range(round(duration / STEP)):
        half = positions + velocity(positions) * STEP / 2
        positions = positions + velocity(half) * STEP
    return positions


def write_frame(folder, time, ids, positions):
    path = os.path.join(folder, f"baseline.{round(time / TIMESTEP)}.dump")
    low, high = (positions.min(axis=0), positions.max(axis=0)) if len(positions) else np.zeros((2, 3))
    with open(path, "w", encoding="ascii") as handle:
        handle.write(f"ITEM: TIMESTEP\n{round(time / TIMESTEP)}\nITEM: NUMBER OF ATOMS\n{len(ids)}\nITEM: BOX BOUNDS ff ff ff\n")
        np.savetxt(handle, np.column_stack([low, high]), fmt="%.8g")
        handle.write("ITEM: ATOMS id x y z\n")
        np.savetxt(handle, np.column_stack([ids, positions]), fmt="%d %.9g %.9g %.9g")


def check(options):
    """Raises AnalysisError for a rate or length that is no positive number."""
    for name in ("time", "outflow", "diffusion", "start"):
        if not 0 < getattr(options, name) < math.inf:
            raise AnalysisError(f"--{name} is {getattr(options, name):g} but must be positive and finite")


def write_baseline(folder, model, packing, scene, times, outflow, diffusion=DIFFUSION, start=START):
    """Dumps of "nothing" or "kinematic" in d and tau; returns the number of grains at the end.

    packing : Frame at rest; scene : its Scene; times : (n,) tau, of the snapshots, from 0 on
    outflow : grains a tau; diffusion : b, d; start : variance of the profile at z = 0, d^2
    """
    ids, positions = packing.ids, scene.positions(packing.positions)
    container = scene.container()
    slab = (np.abs(positions[:, 0]) < 15) & (positions[:, 2] > 15) & (positions[:, 2] < 45)
    if model == "kinematic" and not slab.any():
        raise AnalysisError("the packing: no grain in |x| < 15 d, 15 d < z < 45 d, whose density makes the outflow a flux")
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, "scene.json"), "w", encoding="utf-8") as handle:
        json.dump({"format": FORMAT, "program": f"baseline: {model}", "diameter": 1.0, "gravity": 1.0, "timestep": TIMESTEP,
                   "half_width_x": container.half_width, PERIOD_KEY if container.periodic else "half_depth_y": container.half_depth,
                   "orifice_radius": container.orifice_radius}, handle)
    flux = outflow / max(slab.sum(), 1) * 30 * 30  # over the depth; the density is that of the slab
    for time, before in zip(times, [times[0], *times]):
        if model == "kinematic":
            positions = follow(positions, time - before,
                               lambda places: kinematic_velocity(places, flux, diffusion, start))
            left = positions[:, 2] > OUTLET
            ids, positions = ids[left], positions[left]
        write_frame(folder, time, ids, positions)
    return len(ids)


def main():
    options = parse_arguments()
    check(options)
    scene = command_line.scene_from_options(options, options.packing)
    times = np.arange(int(options.time / LAG_TAU + 1e-9) + 1) * LAG_TAU
    grains = write_baseline(options.output, options.model, next(read_frames(options.packing)), scene, times, options.outflow,
                            options.diffusion, options.start)
    print(f"{options.output}: {len(times)} snapshots of {grains} grains at the end")


if __name__ == "__main__":
    command_line.run(main)
