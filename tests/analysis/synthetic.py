# SPDX-License-Identifier: GPL-2.0-or-later
"""Synthetic packings and dumps with known answers."""

import gzip
import itertools
import json
import math
import struct

import numpy as np
import zstandard

SCENE = {"program": "synthetic", "diameter": 1.0, "gravity": 1.0, "timestep": 0.01,
         "half_width_x": 10.0, "half_depth_y": 4.0, "orifice_radius": 12.0}  # no base: the plug falls through
LAYER = 0.99  # d between the layers of the plug: neighbours above and below overlap by 0.01 d
SPACING = 1.001  # d between its columns


def frame_text(timestep, ids, positions, columns="id x y z", before="", box=((-1, 1), (-2, 2), (0, 4)), extra=()):
    """One frame; ``extra`` holds further columns by name, (name, values)."""
    values = dict(zip(("id", "x", "y", "z"), (ids, *np.asarray(positions).T)), type=np.ones(len(ids)), **dict(extra))
    names = columns.split()
    rows = "".join(" ".join(f"{values[name][row]:.12g}" for name in names) + " \n" for row in range(len(ids)))
    bounds = "".join(f"{low} {high}\n" for low, high in box)
    return (f"{before}ITEM: TIMESTEP\n{timestep}\nITEM: NUMBER OF ATOMS\n{len(ids)}\n"
            f"ITEM: BOX BOUNDS ff ff ff\n{bounds}ITEM: ATOMS {columns} \n{rows}")


def binary_frame(timestep, columns, ranks=1, box=((-1, 1), (-2, 2), (0, 4)), periodic=(0, 0, 0), time=None, order="<", kind="DUMPCUSTOM"):
    """One frame as LAMMPS writes it into FILE.bin; columns : name -> (n,); ranks : each has a block of atoms."""
    rows = np.stack([np.asarray(values, dtype=float) for values in columns.values()], axis=1)
    text = lambda words: struct.pack(f"{order}i", len(words)) + words.encode()
    flags = [0 if axis else 1 for axis in periodic for _ in range(2)]
    head = struct.pack(f"{order}q", -len(kind)) + kind.encode() + struct.pack(f"{order}iiqqi6i6di", 1, 2, timestep, len(rows), 0, *flags,
                                                                             *np.ravel(box), len(columns))
    head += text("") + (b"\0" if time is None else struct.pack(f"{order}Bd", 1, time)) + text(" ".join(columns))
    blocks = [struct.pack(f"{order}i", part.size) + part.astype(f"{order}f8").tobytes() for part in np.array_split(rows, ranks)]
    return head + struct.pack(f"{order}i", ranks) + b"".join(blocks)


def write_frames(folder, frames, scene, columns=()):
    """Dumps of Frames with the columns of ``extra`` that are named, and scene.json, in a folder that is made; returns it."""
    folder.mkdir(exist_ok=True)
    folder.joinpath("scene.json").write_text(json.dumps(scene))
    for frame in frames:
        extra = [(name, frame.extra[name]) for name in columns]
        folder.joinpath(f"drain.{frame.timestep}.dump").write_text(
            frame_text(frame.timestep, frame.ids, frame.positions, " ".join(["id x y z", *columns]), extra=extra))
    return folder


def write_text(path, text):
    """Write plain text, or gzip or zstd if the name says so; returns the path as text."""
    compress = {".gz": gzip.compress, ".zst": zstandard.compress}.get(path.suffix, bytes)
    path.write_bytes(compress(text.encode()))
    return str(path)


def plug():
    """A lattice of 20 x 8 columns 80 layers high in the silo of SCENE; returns (12800, 3) in d."""
    x = (np.arange(20) - 9.5) * SPACING
    y = (np.arange(8) - 3.5) * SPACING
    z = (np.arange(80) + 0.3) * LAYER
    return np.array(list(itertools.product(x, y, z)))


def write_plug_flow(folder, speed, times, scene=None, files=True):
    """Dumps of the plug falling at ``speed`` (layers per 2 tau), grains below z = 0 removed, and scene.json.

    scene : SCENE or one in other units of length and time
    """
    scene = scene or SCENE
    tau = math.sqrt(scene["diameter"] / scene["gravity"])
    folder.mkdir()
    (folder / "scene.json").write_text(json.dumps(scene))
    start, ids, texts = plug(), np.arange(1, 12801), []
    for time in times:
        positions = start - [0, 0, speed * LAYER * time / 2]
        left = positions[:, 2] > 0
        step = round(time * tau / scene["timestep"])
        texts.append((step, frame_text(step, ids[left], positions[left] * scene["diameter"])))
    if files:
        for step, text in texts:
            write_text(folder / f"run.{step}.dump.gz", text)
    else:
        write_text(folder / "run.dump", "".join(text for _, text in texts))
    return str(folder)


def fcc(cells, spacing):
    """Face-centred cubic crystal of ``cells`` = (nx, ny, nz) cubes with nearest neighbours ``spacing`` apart."""
    corners = np.array(list(itertools.product(*(range(n) for n in cells))), dtype=float)
    basis = np.array([[0, 0, 0], [0.5, 0.5, 0], [0.5, 0, 0.5], [0, 0.5, 0.5]])
    return (corners[:, None] + basis).reshape(-1, 3) * spacing * math.sqrt(2)


def sequential_packing(rng, grains, low, high, closest):
    """Random sequential addition: points in a box, none closer than ``closest``."""
    placed = np.empty((0, 3))
    while len(placed) < grains:
        point = rng.uniform(low, high)
        if not len(placed) or np.min(((placed - point)**2).sum(axis=1)) > closest**2:
            placed = np.vstack([placed, point])
    return placed


def hcp(cells, spacing):
    """Hexagonal close-packed crystal of ``cells`` = (nx, ny, nz) orthorhombic cells, neighbours ``spacing`` apart."""
    corners = np.array(list(itertools.product(*(range(n) for n in cells))), dtype=float)
    basis = np.array([[0, 0, 0], [0.5, 0.5, 0], [0.5, 5 / 6, 0.5], [0, 1 / 3, 0.5]])
    return (corners[:, None] + basis).reshape(-1, 3) * spacing * [1, math.sqrt(3), math.sqrt(8 / 3)]


def middle_of(points):
    """The points shifted so that the middle of their extent is the origin in x and y; the lowest keeps its height."""
    shift = (points.max(axis=0) + points.min(axis=0)) / 2
    return points - [shift[0], shift[1], 0]


def make_snapshots(packings, times, container, region):
    """Snapshots of packings (n, 3); a row that is not a number is a grain that has left."""
    from spot_analysis.statistics.snapshot import Snapshot
    for time, packing in zip(times, packings):
        here = np.isfinite(packing[:, 0])
        yield Snapshot(float(time), np.flatnonzero(here) + 1, packing[here], container, region)


def measure(concept, packings, times, container, region):
    """The arrays of ``concept``.Measurement after these packings, as RunStatistics.measured holds them."""
    from types import SimpleNamespace

    from spot_analysis.statistics.history import History
    from spot_analysis.statistics.snapshot import LAG_TAU
    measurement, history = concept.Measurement(container, region), History(LAG_TAU)
    for snapshot in make_snapshots(packings, times, container, region):
        history.add(snapshot)
        measurement.add(snapshot, history)
    return SimpleNamespace(**measurement.arrays())
