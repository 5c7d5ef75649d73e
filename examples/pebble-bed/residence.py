#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""How long pebbles stay in the bed, how fast they come down where, and how dense the bed stays: tables and a picture.

    residence.py FOLDER [-o FILE.png]

FOLDER has the dumps of in.pebble_bed, of two turnovers at least.
"""

import argparse
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "analysis"))

from spot_analysis.base.interpreter import require_packages

require_packages("numpy", "matplotlib", "zstandard")

import numpy as np  # noqa: E402  (only after the check above)

from spot_analysis.base.errors import DumpError  # noqa: E402
from spot_analysis.reading.dump import read_frames  # noqa: E402

D, TAU_STEPS = 0.06, 2  # pebble diameter (m); steps a tau
RADIUS = 12 * D
HEIGHTS = (8, 16)  # of the layers in which velocities are measured (diameters), each 4 d high
COLUMN = "f_bed[5]"  # how often a pebble has drained


def measure(folder):
    """(times, passages, positions): (f,) in tau, (f, n) counts, (f, n, 3) in diameters; n pebbles in f snapshots."""
    times, passages, positions = [], [], []
    for frame in read_frames(folder, extra=(COLUMN,)):
        if COLUMN not in frame.extra:
            raise DumpError(f"{folder}: step {frame.timestep} has no column {COLUMN}")
        times.append(frame.timestep / TAU_STEPS)
        passages.append(frame.extra[COLUMN].astype(int))
        positions.append(frame.positions / D)
    return np.array(times), np.array(passages), np.array(positions)


def residence_times(times, passages, latest):
    """Of each stay that began by `latest` (tau), how long it was (tau); infinity where it had not ended."""
    stays = []
    for counts in passages.T:
        came = [times[np.searchsorted(counts, k)] for k in range(1, counts[-1] + 1)]
        ended = came[1:] + [np.inf]
        stays += [end - begin for begin, end in zip(came, ended) if begin <= latest]
    return np.sort(stays)


def fall_speeds(times, passages, positions, low, high, edges):
    """Mean fall (d / tau) of pebbles between two heights, by distance from the axis."""
    fall, count = np.zeros(len(edges) - 1), np.zeros(len(edges) - 1)
    for k in range(len(times) - 1):
        at, to = positions[k], positions[k + 1]
        stays = (passages[k] == passages[k + 1]) & (at[:, 2] > low) & (at[:, 2] < high)
        where = np.digitize(np.hypot(at[stays, 0], at[stays, 1]), edges) - 1
        for values, total in (((at - to)[stays, 2], fall), (np.ones(stays.sum()), count)):
            np.add.at(total, where[where < len(total)], values[where < len(total)])
    return fall / count / (times[1] - times[0])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("-o", "--output", metavar="FILE.png")
    arguments = parser.parse_args()
    try:
        times, passages, positions = measure(arguments.folder)
    except DumpError as error:
        sys.exit(f"residence.py: {error}")
    turned = passages.mean(axis=1)
    if turned[-1] < 2:
        sys.exit(f"residence.py: {arguments.folder}: {turned[-1]:.2f} turnovers, but two are needed")
    turnover = times[-1] / turned[-1]
    print(f"{len(passages[0])} pebbles, {turned[-1]:.2f} turnovers of {turnover:.1f} tau")

    stays = residence_times(times, passages, times[-1] - 2 * turnover) / turnover
    print(f"{len(stays)} stays, in turnovers: median {np.median(stays):.2f}, 5 % below {np.quantile(stays, 0.05):.2f}, "
          f"95 % below {np.quantile(stays, 0.95):.2f}, longer than two {np.mean(stays > 2):.3f}")
    never = np.mean(passages[-1] == 0)
    print(f"never drained: {never:.3f}")

    edges = np.linspace(0, 12, 13)
    steady = turned >= 1
    profiles = [fall_speeds(times[steady], passages[steady], positions[steady], z - 2, z + 2, edges) for z in HEIGHTS]
    print("r (d)  " + "  ".join(f"v at {z} d (d/tau)" for z in HEIGHTS))
    for k in range(len(edges) - 1):
        print(f"{(edges[k] + edges[k + 1]) / 2:5.1f}  " + "  ".join(f"{profile[k]:16.4f}" for profile in profiles))
    for first in range(int(turned[-1])):
        frames = positions[(turned >= first) & (turned < first + 1)]
        inside = (frames[:, :, 2] > 8) & (frames[:, :, 2] < 16)
        fraction = inside.sum() / len(frames) * np.pi / 6 / (np.pi * 12**2 * 8)
        print(f"turnover {first + 1}: packing fraction {fraction:.4f}, highest pebble {frames[:, :, 2].max():.1f} d")
    if arguments.output:
        plot(arguments.output, stays, edges, profiles)


def plot(path, stays, edges, profiles):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    left.hist(np.minimum(stays, 2.0), bins=np.linspace(0, 2.05, 42), density=True, color="0.55")
    left.set(xlabel="time from coming in to draining (turnovers; 2: or longer)", ylabel="density")
    for z, profile in zip(HEIGHTS, profiles):
        right.plot((edges[1:] + edges[:-1]) / 2, profile, "o-", label=f"{z} d above the outlet")
    right.set(xlabel="distance from the axis (d)", ylabel="fall (d / tau)", xlim=(0, 12), ylim=(0, None))
    right.legend()
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    main()
