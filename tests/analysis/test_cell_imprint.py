# SPDX-License-Identifier: GPL-2.0-or-later
"""cell_imprint.py: none is found where there is none, and what is planted is."""

import json

import numpy as np
import pytest
from spot_analysis.reading.container import Container
from spot_analysis.statistics import cell_imprint
from spot_analysis.statistics.snapshot import Snapshot

from conftest import script
from synthetic import frame_text, write_text

CONTAINER = Container(25.0, 4.0, 4.0)
ORIGIN = np.array([-24.5, -3.5, 0.0])
SNAPSHOTS = 6


def drawn_into_cells(values, axis, depth):
    """Moves places along an axis so that their density varies as 1 - 2 pi depth cos(2 pi x / EDGE) in cells."""
    phase = (values[:, axis] - ORIGIN[axis]) / cell_imprint.EDGE % 1
    values[:, axis] += depth * cell_imprint.EDGE * np.sin(2 * np.pi * phase)
    return values


def packings(seed, axis=0, depth=0.0, restless=0.0):
    """Points that fall and diffuse, fewer and by longer steps higher up; with a planted density, or with steps that are longer
    near the edges of cells."""
    rng = np.random.default_rng(seed)
    for number in range(SNAPSHOTS):
        points = rng.uniform((-24.5, -3.5, 0), (24.5, 3.5, 90), (30_000, 3))
        points[:, 2] *= (points[:, 2] / 90)**0.2
        points = drawn_into_cells(points, axis, depth)
        points[0] = ORIGIN
        near = np.abs((points[:, axis] - ORIGIN[axis]) / cell_imprint.EDGE % 1 - 0.5) > 0.25
        length = np.where(near, 1 + restless, 1) * (1 + points[:, 2] / 90)
        step = rng.normal(0, 0.05, (len(points), 3)) * length[:, None] - (0, 0, 0.1)
        yield points, points + step


def imprints(periods=(cell_imprint.EDGE,), **planted):
    measurement, ids = cell_imprint.Measurement(CONTAINER, periods), np.arange(30_000)
    for number, (before, after) in enumerate(packings(**planted)):
        if number == 0:
            measurement.start(before)
        earlier, later = (Snapshot(2.0 * number + time, ids, points, CONTAINER, None) for time, points in ((0, before), (2, after)))
        measurement.add(later, earlier)
    return measurement.imprints()


def test_none_is_found_where_there_is_none():
    p_values = [one.p_value for seed in range(10, 14) for found in imprints(seed=seed).values() for one in found.values()]
    assert len(p_values) == 24 and min(p_values) > 1e-3 and 0.3 < np.mean(p_values) < 0.7


@pytest.mark.parametrize("axis, name", [(0, "x"), (2, "z")])
def test_planted_density_is_found(axis, name):
    found = imprints(seed=10, axis=axis, depth=0.02)
    grains = found[name, cell_imprint.EDGE]["grains"]
    assert grains.p_value < 1e-4
    expected = 1 - 2 * np.pi * 0.02 * np.cos(2 * np.pi * cell_imprint.DISTANCE / cell_imprint.EDGE)
    assert np.all(np.abs(grains.profile - expected) < 4 * grains.error + 0.02)  # to first order, before the step
    assert found["z" if name == "x" else "x", cell_imprint.EDGE]["grains"].p_value > 1e-3
    assert found[name, cell_imprint.EDGE]["sideways"].p_value > 1e-3


def test_planted_motion_is_found_in_cells_of_its_size_only():
    found = imprints(seed=11, restless=0.2, periods=(cell_imprint.EDGE, 1.3))
    assert found["x", cell_imprint.EDGE]["sideways"].p_value < 1e-4
    profile = found["x", cell_imprint.EDGE]["sideways"].profile
    assert profile[:3].mean() / profile[-3:].mean() == pytest.approx(1.44, abs=0.1)
    assert found["x", 1.3]["sideways"].p_value > 1e-3
    assert found["x", cell_imprint.EDGE]["grains"].p_value > 1e-3


def test_overlaps():
    positions = np.array([[0, 0, 0], [0.9, 0, 0], [0, 0.8, 0], [3, 0, 0]])
    assert cell_imprint.squared_overlaps(positions) == pytest.approx([0.05, 0.01, 0.04, 0])


def test_command(tmp_path):
    (tmp_path / "scene.json").write_text(json.dumps({"diameter": 1.0, "gravity": 1.0, "timestep": 0.01, "half_width_x": 25.0,
                                                     "half_depth_y": 4.0, "orifice_radius": 4.0}))
    for number, packing in enumerate(next(packings(seed=3))):
        write_text(tmp_path / f"run.{200 * number}.dump.gz", frame_text(200 * number, np.arange(1, len(packing) + 1), packing))
    done = script("cell_imprint.py", tmp_path, "--from", 0)
    assert done.returncode == 0, done.stderr
    rows = [line.split(" | ") for line in done.stdout.splitlines()[2:]]
    assert [row[0].strip("| ") + " " + row[1] for row in rows] == ["x grains", "x overlap", "x sideways", "z grains", "z overlap", "z sideways"]
    assert all(float(row[4]) > 1e-3 for row in rows)
