# SPDX-License-Identifier: GPL-2.0-or-later
"""g(r) and Voronoi cells against LAMMPS' compute rdf and compute voronoi/atom, run by the distribution's lmp."""

import itertools
import shutil
import subprocess

import numpy as np
import pytest
from spot_analysis.reading.container import Container
from spot_analysis.reading.dump import read_file
from spot_analysis.statistics import neighbours, radial_distribution, voronoi_cells
from spot_analysis.statistics.region import Region

from synthetic import sequential_packing

LMP = shutil.which("lmp")
pytestmark = pytest.mark.skipif(LMP is None, reason="needs lmp on the PATH (Debian: apt install lammps)")
BOX = np.array([12.0, 8.0, 14.0])


def run(folder, points, low, high, boundary, commands):
    """Read the points and run the commands for no step; returns the folder of the output."""
    (folder / "points.data").write_text(
        f"points\n\n{len(points)} atoms\n1 atom types\n\n" + "".join(
            f"{a:.15g} {b:.15g} {axis}lo {axis}hi\n" for axis, a, b in zip("xyz", low, high))
        + "\nAtoms # atomic\n\n" + "".join(
            f"{number} 1 " + " ".join(f"{value:.15g}" for value in point) + "\n" for number, point in enumerate(points, 1)))
    (folder / "in.points").write_text(
        f"units lj\natom_style atomic\nboundary {boundary}\nread_data points.data\nmass 1 1\npair_style zero 5.0\n"
        f"pair_coeff * *\n{commands}\nrun 0\n")
    result = subprocess.run([LMP, "-in", "in.points", "-log", "none"], cwd=folder, capture_output=True, text=True)
    assert result.returncode == 0, result.stdout + result.stderr


def test_rdf_of_a_periodic_packing(tmp_path):
    """Periodic in x and z, walls in y: each grain of one period has the partners that LAMMPS counts."""
    points = sequential_packing(np.random.default_rng(2), 900, [0, 0, 0], BOX, 0.9)
    run(tmp_path, points, [0, 0, 0], BOX, "p f p", "compute rdf all rdf 200\n"
        "fix out all ave/time 1 1 1 c_rdf[*] mode vector file rdf.txt")
    rows = np.loadtxt(tmp_path / "rdf.txt", skiprows=4)
    shells = np.diff(np.linspace(0, 5, 201)**3) * 4 / 3 * np.pi
    expected = rows[:, 2] * shells * (len(points) - 1) / BOX.prod() * len(points)

    shifts = np.array(list(itertools.product((-1, 0, 1), (0,), (-1, 0, 1)))) * BOX
    images = (points + shifts[:, None]).reshape(-1, 3) - [6, 4, 0]
    # the region is one period, but for grains that lie on its border
    pairs = neighbours.region_pairs(images, Region(6, 0, BOX[2]))
    assert pairs.grains == len(points)
    np.testing.assert_allclose(radial_distribution.rdf_counts(pairs), expected, rtol=1e-4, atol=0.01)
    np.testing.assert_allclose(np.cumsum(radial_distribution.rdf_counts(pairs)) / len(points), rows[:, 3], rtol=1e-4)


def test_voronoi_cells_between_walls(tmp_path):
    """LAMMPS cuts the cells off at a fixed box, as mirror images do."""
    points = sequential_packing(np.random.default_rng(4), 900, [-6, -4, 0], [6, 4, 14], 0.95)
    run(tmp_path, points, [-6, -4, 0], [6, 4, 14], "f f f", "compute cells all voronoi/atom\n"
        "dump out all custom 1 cells.dump id x y z c_cells[1]\ndump_modify out sort id format float %.12g")
    frame = next(read_file(str(tmp_path / "cells.dump"), extra=("c_cells[1]",)))
    expected = frame.extra["c_cells[1]"]
    volumes = voronoi_cells.cells_in_container(points, Container(6, 4, 1e-9))
    # the lid of LAMMPS' box is no wall here
    compared = (points[:, 2] < 10) & np.isfinite(volumes)
    assert compared.sum() > 500
    np.testing.assert_allclose(volumes[compared], expected[compared], rtol=1e-6)


FORMS = {"wrapped": "x y z ix iy iz", "unwrapped": "xu yu zu", "scaled": "xs ys zs ix iy iz", "scaled_unwrapped": "xsu ysu zsu",
         "mixed": "x ix yu zsu z iz"}


@pytest.mark.parametrize("boundary, box", [("p p f", ""), ("p f p", "change_box all triclinic\n")])
def test_periodic_boxes(tmp_path, boundary, box):
    """Grains that go around the box are where LAMMPS' unwrapped positions say, whatever the columns."""
    points = sequential_packing(np.random.default_rng(5), 100, [0.5, 3, 3], BOX - [0.5, 3, 3], 0.9)
    dumps = "".join(f"dump {name} all custom 20 {name}.dump id {columns}\ndump_modify {name} format float %.14g\n"
                    for name, columns in FORMS.items())
    run(tmp_path, points, [0, 0, 0], BOX, boundary, f"{box}neigh_modify every 1 delay 0 check no\ntimestep 1\n"
        f"fix moves all move linear 1.7 0.01 -0.02\n{dumps}run 20")
    start, expected = read_file(str(tmp_path / "unwrapped.dump"))
    np.testing.assert_allclose(expected.positions - start.positions, np.tile([34, 0.2, -0.4], (100, 1)), atol=1e-9)
    for name in FORMS:
        *_, found = read_file(str(tmp_path / f"{name}.dump"))
        np.testing.assert_allclose(found.positions, expected.positions, atol=1e-9, err_msg=name)
    head = (tmp_path / "wrapped.dump").read_text().splitlines()[4]
    assert head == "ITEM: BOX BOUNDS " + ("xy xz yz pp ff pp" if box else "pp pp ff")
