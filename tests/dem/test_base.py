# SPDX-License-Identifier: GPL-2.0-or-later
"""The STL mesh of the base: where it has material, where it has not, and that LIGGGHTS can use it."""

import re
import subprocess
import sys

import numpy as np
import pytest

from liggghts_runs import DECKS, DIAMETER

SLIVER = 0.3 * DIAMETER
# half width, half depth, radius of the orifice, in diameters: two sizes of silo, a round hole that touches two walls, one far
# from all, one that touches all four.
BASES = [(8, 4, 4), (25, 4, 4), (25, 4, 3), (10, 10, 2), (4, 4, 4)]


def make_base(*lengths, out, words=()):
    """Run make_base.py with lengths in metres."""
    return subprocess.run([sys.executable, DECKS / "silo" / "make_base.py", *map(str, lengths), out, *map(str, words)],
                          capture_output=True, text=True)


def triangles_of(stl):
    corners = re.findall(r"vertex (\S+) (\S+) (\S+)", stl.read_text())
    return np.array(corners, dtype=float).reshape(-1, 3, 3)


def double_area(a, b, c):
    return (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (c[..., 0] - a[..., 0])


@pytest.fixture(params=BASES, ids=lambda base: "x".join(map(str, base)))
def base(request, tmp_path):
    """Half width, half depth, radius (m) and the triangles of the mesh."""
    lengths = [value * DIAMETER for value in request.param]
    done = make_base(*lengths, SLIVER, out=tmp_path / "base.stl")
    assert done.returncode == 0, done.stderr
    return *lengths, triangles_of(tmp_path / "base.stl")


def test_flat_inside_the_box_and_facing_up(base):
    half_width, half_depth, _, triangles = base
    assert (triangles[..., 2] == 0).all()
    assert np.abs(triangles[..., 0]).max() <= half_width * (1 + 1e-9)
    assert np.abs(triangles[..., 1]).max() <= half_depth * (1 + 1e-9)
    assert (double_area(*triangles.transpose(1, 0, 2)) > 0).all()


def test_area_is_rectangle_less_orifice(base):
    half_width, half_depth, radius, triangles = base
    area = double_area(*triangles.transpose(1, 0, 2)).sum() / 2
    # Slivers: the band between the rim and a wall it comes within 0.3 d of, by numerical quadrature.
    angle = (np.arange(200000) + 0.5) * 2 * np.pi / 200000
    to_wall = np.minimum(half_width / np.abs(np.cos(angle)), half_depth / np.abs(np.sin(angle)))
    gap = np.minimum(half_width - radius * np.abs(np.cos(angle)), half_depth - radius * np.abs(np.sin(angle)))
    plate = np.where(gap > SLIVER, (to_wall**2 - radius**2) / 2, 0).mean() * 2 * np.pi
    assert area == pytest.approx(plate, abs=0.02 * np.pi * radius**2)


def test_covers_the_plate_once_and_nothing_else(base):
    half_width, half_depth, radius, triangles = base
    points = np.random.default_rng(7).uniform(-1, 1, (4000, 2)) * (half_width, half_depth)
    a, b, c = (triangles[:, i, None] for i in range(3))
    covered = ((double_area(a, b, points) > 0) & (double_area(b, c, points) > 0) & (double_area(c, a, points) > 0)).sum(axis=0)
    distance = np.hypot(*points.T)
    angle = np.arctan2(*points.T[::-1])
    gap = np.minimum(half_width - radius * np.abs(np.cos(angle)), half_depth - radius * np.abs(np.sin(angle)))
    assert (covered[distance < 0.998 * radius] == 0).all()
    assert (covered[(distance > radius) & (gap > 1.5 * SLIVER)] == 1).all()
    assert covered.max() == 1


def test_watertight_around_the_orifice(base):
    """Each edge belongs to two triangles, or lies on the rim, on a wall, or where a sliver is left out."""
    half_width, half_depth, radius, triangles = base
    edges = {}
    for triangle in np.round(triangles[..., :2] / DIAMETER, 6):
        corners = [tuple(corner) for corner in triangle]
        for edge in zip(corners, corners[1:] + corners[:1]):
            edges[edge] = edges.get(edge, 0) + 1
    assert max(edges.values()) == 1  # none is run along twice in one direction
    limit = np.array([half_width, half_depth]) / DIAMETER
    on_rim = 0
    for start, end in edges:
        if (end, start) in edges:
            continue
        ends = np.array([start, end])
        distance = np.hypot(*ends.T)
        rim = np.allclose(distance, radius / DIAMETER, atol=1e-5)
        wall = any(np.allclose(np.abs(ends[:, axis]), limit[axis], atol=1e-5) for axis in (0, 1))
        spoke = abs(np.cross(*ends)) < 1e-4 * np.prod(distance)
        assert rim or wall or spoke, (start, end)
        on_rim += rim
    assert on_rim > 20


@pytest.mark.parametrize("words, centres", [
    (("--holes", 2), (-12.5, 12.5)),
    (("--holes", 2, "--open", 1), (-12.5,)),
    (("--slot", 1), (0,)),
    (("--slot", 1, "--holes", 3, "--open", 3), (50 / 3,))])
def test_several_openings_and_slots(words, centres, tmp_path):
    """The plate is where no opening is, once, and lids are where those are that are not open."""
    done = make_base(*(value * DIAMETER for value in (25, 8, 4)), SLIVER, out=tmp_path / "base.stl", words=words)
    assert done.returncode == 0, done.stderr
    a, b, c = (triangles_of(tmp_path / "base.stl")[:, i, None] for i in range(3))
    assert (double_area(a[:, 0], b[:, 0], c[:, 0]) > 0).all()
    points = np.random.default_rng(7).uniform(-1, 1, (4000, 2)) * np.array([25, 8]) * DIAMETER
    covered = ((double_area(a, b, points) > 0) & (double_area(b, c, points) > 0) & (double_area(c, a, points) > 0)).sum(axis=0)
    away = points[:, :1] - np.array(centres) * DIAMETER
    distance = np.abs(away) if "--slot" in words else np.hypot(away, points[:, 1:])
    distance = distance.min(axis=1)
    assert (covered[distance < 0.998 * 4 * DIAMETER] == 0).all()
    assert (covered[distance > 4 * DIAMETER] == 1).all()


@pytest.mark.parametrize("lengths, word", [
    ((8, 4, 4.2, 0.3), "half depth"),
    ((3, 4, 3.5, 0.3), "half width"),
    ((8, 4, 0, 0.3), "positive"),
    ((8, 4, 4, -1), "negative"),
    ((4, 4, 4, 3), "slivers"),
    ((8, 4, "wide", 0.3), "wide"),
])
def test_base_that_cannot_be_made(lengths, word, tmp_path):
    done = make_base(*lengths, out=tmp_path / "base.stl")
    assert done.returncode != 0
    assert word in done.stderr
    assert not (tmp_path / "base.stl").exists()


@pytest.mark.parametrize("words, said", [
    (("--holes", 2, "--open", 3), "open (3)"),
    (("--holes", 0), "holes (0)"),
    (("--slot", 1, "--holes", 8), "slot"),
])
def test_openings_that_do_not_fit(words, said, tmp_path):
    done = make_base(25, 8, 4, 0.3, out=tmp_path / "base.stl", words=words)
    assert done.returncode != 0 and said in done.stderr
    assert not (tmp_path / "base.stl").exists()
