# SPDX-License-Identifier: GPL-2.0-or-later
"""Run LIGGGHTS decks in a subprocess and read the dumps they write."""

import os
import pathlib
import shutil
import subprocess

import numpy as np

DECKS = pathlib.Path(__file__).resolve().parents[2] / "liggghts-inputs"
LIGGGHTS = os.environ.get("LIGGGHTS") or shutil.which("liggghts")

# The bead of the decks (SI).
DIAMETER = 3e-3
GRAVITY = 9.81
MASS = 2500 * np.pi / 6 * DIAMETER**3
TAU = np.sqrt(DIAMETER / GRAVITY)


def run(folder, deck, launcher=(), **variables):
    """Run liggghts-inputs/folder/deck with the given -var values; returns the finished process."""
    command = [*launcher, LIGGGHTS, "-in", deck, "-log", "none"]
    for name, value in variables.items():
        command += ["-var", name, str(value)]
    return subprocess.run(command, cwd=DECKS / folder, capture_output=True, text=True,
                          errors="replace",  # LIGGGHTS ends some messages in stray bytes
                          timeout=600)


def run_ok(folder, deck, **variables):
    done = run(folder, deck, **variables)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    return done.stdout


def read_dump(path):
    """Frames of a text dump: a list of (step, {column: values})."""
    frames = []
    with open(path, encoding="ascii") as dump:
        while dump.readline():
            step = int(dump.readline())
            dump.readline()
            count = int(dump.readline())
            for _ in range(4):
                dump.readline()
            columns = dump.readline().split()[2:]
            rows = np.array([dump.readline().split() for _ in range(count)], dtype=float).reshape(count, len(columns))
            frames.append((step, dict(zip(columns, rows.T))))
    return frames
