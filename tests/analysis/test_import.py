# SPDX-License-Identifier: GPL-2.0-or-later
"""import_packing.py: every format gives the same packing, which comes back from any axes and units; overlaps, walls, and what is refused."""

import gzip
import sys

import numpy as np
import pytest
import scipy.spatial

from conftest import ANALYSIS, script
from synthetic import frame_text, write_text

from spot_analysis.base.errors import AnalysisError
from spot_analysis.commands import import_packing
from spot_analysis.importing import fitting, overlaps, walls
from spot_analysis.importing.snapping import snapped
from spot_analysis.importing.turning import direction, turned
from spot_analysis.reading.packing_file import read_packing

EXAMPLES = ANALYSIS.parent / "examples"
VERSION = (ANALYSIS.parent / "VERSION").read_text().strip()
HOPPER, D = EXAMPLES / "own-hopper" / "packing.data.gz", 0.003
CONE = "--cone 0 0 0.012 0.03 0.045 --orifice 0.012".split()
TEN = np.array([[x, y, z] for x in (-1.5, 0, 1.5) for y in (-1.5, 0, 1.5) for z in (0.5,)] + [[0.2, 0.1, 1.75]])
BOX = "--box -3 3 -3 3 --orifice 2".split()


@pytest.fixture(scope="module")
def hopper():
    return read_packing(str(HOPPER)).positions


def imported(folder, *words):
    """(ids, diameter, density, positions) of packing.data, and the deck, of a call that has to succeed."""
    done = script("import_packing.py", *words, "-o", folder)
    assert done.returncode == 0, done.stderr
    text = (folder / "packing.data").read_text()
    rows = np.array(text.split("Atoms # sphere")[1].split(), dtype=float).reshape(-1, 7)
    assert len(set(rows[:, 3])) == 1 and f"\n{len(rows)} atoms\n" in text
    sizes = rows[:, 2] if np.ptp(rows[:, 2]) else rows[0, 2]
    return rows[:, 0], sizes, rows[0, 3], rows[:, 4:], (folder / "in.spot").read_text()


def refusal(monkeypatch, capsys, *words):
    """The line that a call ends with; in this process, which is faster."""
    monkeypatch.setattr(sys, "argv", ["spot-import", *map(str, words)])
    with pytest.raises(SystemExit) as error:
        import_packing.main()
    assert isinstance(error.value.code, str)  # Python prints it, and ends with 1
    assert error.value.code.startswith("error: ") and "\n" not in error.value.code
    capsys.readouterr()
    return error.value.code


def data_text(points, diameters=None, style=" # sphere", density=2600):
    diameters = np.ones(len(points)) if diameters is None else diameters
    rows = "".join(f"{k} 1 {d:.12g} {density} {x:.12g} {y:.12g} {z:.12g}\n" for k, (d, (x, y, z)) in enumerate(zip(diameters, points), 1))
    return f"made for a test\n\n{len(points)} atoms\n1 atom types\n\n-9 9 xlo xhi\n-9 9 ylo yhi\n-9 9 zlo zhi\n\nAtoms{style}\n\n{rows}"


def rows_text(points, *more, separator=" "):
    return "".join(separator.join(f"{value:.12g}" for value in (*point, *more)) + "\n" for point in points)


FORMATS = {
    "liggghts.dump": frame_text(0, range(1, 11), TEN + 5, "id type x y z radius", extra=[("radius", [0.5] * 10)])
    + frame_text(700, range(1, 11), TEN, "id type x y z radius", extra=[("radius", [0.5] * 10)]),
    "lammps.dump": frame_text(0, range(1, 11), TEN, "id x y z diameter density",
                              extra=[("diameter", [1.0] * 10), ("density", [2600.0] * 10)]),
    "lammps.data": data_text(TEN),
    "granular.data": data_text(TEN, style="").replace("9 zlo zhi\n", "9 zlo zhi\n\nMasses\n\n1 1.0\n") + "\nVelocities\n\n1 0 0 0 0 0 0\n",
    "lammps.data.gz": data_text(TEN),
    "images.data": data_text(TEN).replace(".5\n", ".5 0 0 0\n").replace("1.75\n", "1.75 0 0 0\n"),
    "yade.txt": "#format x_y_z_r\n" + rows_text(TEN, 0.5, separator="\t"),
    "yade-ext.txt": "# format x_y_z_r_matId\n" + rows_text(TEN, 0.5, 0),
    "yade-ids.txt": "# format id_x_y_z_r_matId\n" + "".join(f"{k} {line} 0.5 2\n" for k, line in enumerate(rows_text(TEN).splitlines())),
    "header.csv": "Y,X,z [m],d,note\n" + "".join(f"{y},{x},{z},1,{k}\n" for k, (x, y, z) in enumerate(TEN)),
    "semicolons.csv": "x;y;z;radius\r\n" + rows_text(TEN, 0.5, separator=";").replace("\n", "\r\n"),
    "bare.txt": rows_text(TEN, 0.5).rstrip("\n"),
}


@pytest.mark.parametrize("name", FORMATS)
def test_every_format_is_the_same_packing(tmp_path, name):
    source = write_text(tmp_path / name, FORMATS[name])
    ids, diameter, density, positions, deck = imported(tmp_path / "out", source, *BOX)
    assert np.array_equal(ids, range(1, 11)) and diameter == 1
    assert density == (2600 if name.startswith(("lammps", "granular", "images")) else 2500)
    assert np.allclose(positions, TEN, rtol=0, atol=1e-9)
    assert deck.startswith(f"# Made by spot-import {VERSION} from {name}: box.\n")
    assert "box -3 3 -3 3 &\n" in deck and "orifice 0 0 0 2 &\n" in deck and "beverloo ${g}" in deck


def test_frames_by_their_step(tmp_path, monkeypatch, capsys):
    source = write_text(tmp_path / "liggghts.dump", FORMATS["liggghts.dump"])
    words = source, *"--box -8 8 -8 8 --orifice 2 --shift -5 -5 -5".split()
    assert np.allclose(imported(tmp_path / "out", *words, "--step", 0)[3], TEN)
    assert "no frame of timestep 5" in refusal(monkeypatch, capsys, *words, "--step", 5)


@pytest.mark.parametrize("axis, place", [("-y", lambda p: p[:, [0, 2, 1]] * [1, 1, -1]), ("+x", lambda p: p[:, [2, 1, 0]] * [-1, 1, 1]),
                                         ("z", lambda p: p * [1, -1, -1]), ("-z", lambda p: p)])
def test_a_hopper_comes_back_from_other_axes_and_units(tmp_path, hopper, axis, place):
    """What the place is: where that gravity has the hopper's points, in mm and somewhere else."""
    there = place(hopper) * 1000
    up = -direction([axis])
    assert np.allclose(there @ up, hopper[:, 2] * 1000)
    moved = there + 7 * up
    text = frame_text(9, range(1, 8001), moved, "id type x y z radius", extra=[("radius", [1.5] * 8000)])
    source = write_text(tmp_path / "post.dump.gz", text)
    _, diameter, _, positions, deck = imported(tmp_path / "out", source, "--length-unit", "mm", "--gravity", axis, "--floor", 0.007, *CONE,
                                               "--outflow", 5700)
    assert diameter == pytest.approx(D, rel=1e-12)
    assert np.allclose(positions, hopper, rtol=0, atol=1e-9)
    assert "walls add cone z 0 0 0.012 0.03 0 0.045 walls add cylinder z 0 0 0.03 0.045 0.105 &" in deck
    assert "variable  F equal 5700 " in deck and "outflow ${F}" in deck


def test_any_direction_of_gravity():
    rng = np.random.default_rng(1)
    points = rng.normal(size=(50, 3))
    for vector in rng.normal(size=(20, 3)):
        down = direction([f"{value}" for value in vector])
        new = turned(points, down)
        assert np.allclose(new[:, 2], -points @ down)
        assert np.allclose(scipy.spatial.distance.pdist(new), scipy.spatial.distance.pdist(points))
        assert np.linalg.det(turned(np.eye(3), down)) == pytest.approx(1)
    assert np.array_equal(turned(points, direction(["-y"])), np.column_stack([points[:, 0], -points[:, 2], points[:, 1]]))


def test_soft_overlaps_are_pushed_apart_inside_the_walls(hopper):
    """Beads squeezed by 2 %, as soft DEM does under weight."""
    squeezed = hopper * 0.98
    inside = walls.around(walls.cone_and_cylinder(0, 0, 0.012, 0.03, 0, 0.045), (0, 0, 0, 0.012), D)
    relaxed = overlaps.relax(squeezed, D, 0.02, inside)
    assert relaxed.before == pytest.approx(overlaps.deepest_pair(squeezed, D)[0]) and relaxed.before > 0.03
    near = scipy.spatial.cKDTree(relaxed.positions).query(relaxed.positions, 2)[0][:, 1]
    assert relaxed.after == pytest.approx(1 - near.min() / D, abs=1e-9) and relaxed.after <= 0.02
    assert relaxed.moved == pytest.approx(np.linalg.norm(relaxed.positions - squeezed, axis=1).max() / D) and 0 < relaxed.moved < 0.5
    assert inside.sticking_out(relaxed.positions, D).max() < 0.02 + 1e-9


def test_a_packing_that_needs_nothing_stays_as_it_is(hopper):
    relaxed = overlaps.relax(hopper, D, 0.02)
    assert relaxed.sweeps == 0 and relaxed.moved == 0 and relaxed.positions is hopper


def test_overlaps_that_are_no_packing(hopper):
    with pytest.raises(AnalysisError, match="overlap by 0.5.* d, more than 0.3 d.*is the diameter"):
        overlaps.relax(hopper, 2 * D, 0.02)
    crowded = np.array(np.meshgrid(*[np.arange(8) * 0.8] * 3)).reshape(3, -1).T  # closer than spheres can be
    with pytest.raises(AnalysisError, match="do not go below 0.02 d without moving grains"):
        overlaps.relax(crowded, 1.0, 0.02, walls.box(-0.5, 6.1, -0.5, 6.1))


def test_walls_are_found_where_they_were(hopper):
    """Within 0.02 d of those that DEM had, whose polygon has 96 sides; the half-angle within 0.1 degrees."""
    found, _ = fitting.fit("cone-and-cylinder", hopper + [0.01, -0.02, 0.5], D, 0.5)
    x, y, low, radius, base, shoulder = found.numbers
    assert np.allclose([x - 0.01, y + 0.02, low - 0.012, radius - 0.03, base - 0.5], 0, atol=0.02 * D)
    assert np.degrees(np.arctan2(radius - low, shoulder - base)) == pytest.approx(np.degrees(np.arctan2(6, 15)), abs=0.1)
    silo = read_packing(str(EXAMPLES / "silo" / "out-of-sample" / "packing.data.gz")).positions
    assert np.allclose(fitting.fit("box", silo, D, 0.0)[0].numbers, np.array([-16, 16, -4, 4]) * D, atol=0.02 * D)


FITTED = "--fit cone-and-cylinder --outflow 5700".split()


@pytest.mark.parametrize("orifice, shift", [(["0.012"], (0, 0, 0)), ("0.1 -0.2 0.3 0.012".split(), (0.1, -0.2, 0.3))])
def test_a_fitted_hopper_is_where_its_outlet_is(tmp_path, orifice, shift):
    """Axis, floor and rim are exactly the outlet's: else scene.json has no walls, and hopper.py refuses it."""
    deck = imported(tmp_path, HOPPER, *FITTED, "--orifice", *orifice, "--shift", *shift)[-1]
    place = " ".join(f"{value:g}" for value in shift)
    words = deck.partition("fix       drain")[2].split("&")
    cone, cylinder = (np.array(part.split()[3:9], dtype=float) for part in words[0].split("walls")[1:])
    assert np.array_equal(cone[[0, 1, 2, 4]], [*shift[:2], 0.012, shift[2]]) and np.array_equal(cylinder[:2], shift[:2])
    assert np.allclose([cone[3], cone[5] - shift[2]], [0.03, 0.045], rtol=0, atol=0.03 * D) and cylinder[2] == cone[3]
    assert f"orifice {place} 0.012 " in words[1]


def test_what_is_farther_off_than_a_fit_stays_there():
    for place in (0.01, 0.03):
        cone = snapped(walls.cone_and_cylinder(place, -place, 4 + place, 10, 0, 8), (0, 0, 0, 4), 1.0).numbers
        cylinder = snapped(walls.cylinder(place, -place, 6), (0, 0, 0, 4), 1.0).numbers
        box = snapped(walls.box(place - 6, place + 6, -3 - place, 3 - place), (0, 0, 0, 4), 1.0).numbers
        left = 0 if place < 0.02 else place
        assert np.allclose(cone, [left, -left, 4 + left, 10, 0, 8]) and np.allclose(cylinder, [left, -left, 6])
        assert np.allclose(box, [left - 6, left + 6, -3 - left, 3 - left])


def rings(radius, layers):
    """Layers of rings of spheres of diameter 1 in a cylinder."""
    points = []
    for z in range(layers):
        r = radius - 0.5
        while r > 0.5:
            angles = 2 * np.pi * (np.arange(int(2 * np.pi * r)) / int(2 * np.pi * r) + 0.3 * z)
            points += [[r * np.cos(a), r * np.sin(a), z + 0.5] for a in angles]
            r -= 1
    return np.array(points)


def test_a_cylinder_is_found_and_a_stray_grain_named(tmp_path, monkeypatch, capsys):
    points = rings(6.0, 12) + [2, -1, 0]
    found, ((_, coverage),) = fitting.fit("cylinder", points, 1.0, 0.0)
    assert np.allclose(found.numbers, [2, -1, 6], atol=1e-3) and coverage > 0.8
    source = write_text(tmp_path / "stray.txt", rows_text(np.vstack([points, [9.0, -1, 3]]), 0.5))
    line = refusal(monkeypatch, capsys, source, *"--fit cylinder --orifice 3".split(), "-o", tmp_path)
    assert "1 grains stick out" in line and f"grain {len(points) + 1} at 9 -1 3 by 1." in line


@pytest.mark.parametrize("shape", ["box", "cylinder"])
def test_walls_of_another_shape_are_refused(hopper, shape):
    with pytest.raises(AnalysisError, match=f"--fit {shape}: the .* grains at it for each d.2, where a wall has more than 0.3"):
        fitting.fit(shape, hopper, D, 0.0)


@pytest.mark.parametrize("shape", ["cylinder", "cone-and-cylinder"])
def test_a_box_is_neither_cylinder_nor_hopper(shape):
    silo = read_packing(str(EXAMPLES / "silo" / "out-of-sample" / "packing.data.gz")).positions
    with pytest.raises(AnalysisError, match=f"--fit {shape}: "):
        fitting.fit(shape, silo, D, 0.0)


def test_walls_by_words_of_the_fix(tmp_path):
    source = write_text(tmp_path / "bare.txt", rows_text(TEN, 0.5))
    words = "walls add block -4 4 -4 4 0 9"
    deck = imported(tmp_path / "out", source, "--walls", words, *"--orifice 0 0 0 2 --beverloo --run 7".split())[4]
    assert f"fix       drain all spot {words} &" in deck and deck.endswith("run       7\n")


def test_sizes(tmp_path, monkeypatch, capsys):
    def source(spread):
        return write_text(tmp_path / "sizes.data", data_text(TEN, 1 + spread * np.linspace(-1, 1, 10)))

    assert imported(tmp_path / "out", source(0.008), *BOX, "--equal-sizes")[1] == pytest.approx(1)
    assert "makes equal what is within 1 %" in refusal(monkeypatch, capsys, source(0.02), *BOX, "--equal-sizes", "-o", tmp_path)
    assert imported(tmp_path / "out", source(0.02), *BOX, "--diameter", 1)[1] == 1
    for spread in (0.008, 0.3):
        _, sizes, _, _, deck = imported(tmp_path / "out", source(spread), *BOX)
        assert np.allclose(sizes, 1 + spread * np.linspace(-1, 1, 10), rtol=1e-8, atol=0)
        assert f"variable  d equal {np.cbrt(np.mean(sizes**3)):.9g} " in deck
    assert "no grain may be more than 2 times as wide" in refusal(monkeypatch, capsys, source(0.4), *BOX, "-o", tmp_path)
    fit = "--fit box --orifice 2".split()
    assert "at them: name the walls by --box" in refusal(monkeypatch, capsys, source(0.02), *fit, "-o", tmp_path)
    assert "at them: give --equal-sizes, or name" in refusal(monkeypatch, capsys, source(0.008), *fit, "-o", tmp_path)


def test_a_mixture_is_relaxed_as_pairs_touch(tmp_path):
    """Two sizes as DEM poured them, squeezed by 1 %: overlaps are of pairs, in the mean of their diameters."""
    packing = EXAMPLES / "bidisperse" / "packing-2.data.gz"
    grains = read_packing(str(packing))
    squeezed = grains.positions * 0.99
    box = walls.around(walls.box(*(0.99 * D * np.array([-10, 10, -4, 4]))), (0, 0, 0, 4 * D), D)
    relaxed = overlaps.relax(squeezed, grains.diameters, 0.02, box)
    assert relaxed.before > 0.01 and relaxed.moved < 0.1

    def deepest(positions):
        apart = scipy.spatial.distance.cdist(positions, positions)
        touching = (grains.diameters[:, None] + grains.diameters) / 2
        np.fill_diagonal(apart, np.inf)
        return (1 - apart / touching).max()

    assert relaxed.before == pytest.approx(deepest(squeezed)) and relaxed.after == pytest.approx(deepest(relaxed.positions))
    assert relaxed.after <= 0.02
    assert box.sticking_out(relaxed.positions, grains.diameters).max() < 0.02 + 1e-9


def test_a_unit_that_was_forgotten_is_told(tmp_path):
    source = write_text(tmp_path / "bare.txt", rows_text(TEN, 0.5))
    assert "warning: grains of 1 m: is the file in another unit?" in script("import_packing.py", source, *BOX, "-o", tmp_path).stderr
    deck = imported(tmp_path / "lj", source, *BOX, "--scale", 1, "--g", 1)[4]
    assert "units     lj\n" in deck and "variable  g equal 1\n" in deck


DAMAGED = {
    "empty.txt": ("", "the file is empty"),
    "comment.txt": ("# x y z r\n", "there is no grain in it"),
    "word.txt": ("1 2 3 0.5\n1 2 x 0.5\n", "line 2: column 'z' is no number: 'x'"),
    "short.txt": ("1 2 3 0.5\n1 2 3\n", "line 2: expected 4 columns (x y z r), found 3"),
    "two.txt": ("1 2\n", "line 1: neither a dump nor a data file, nor columns x y z"),
    "nan.txt": ("1 2 nan 0.5\n", "line 1: column 'z' is not finite: 'nan'"),
    "radius.txt": ("1 2 3 -0.5\n", "a grain has a diameter of -1, which must be positive"),
    "columns.csv": ("x,y,r\n1,2,3\n", "column 'z' is missing (the columns are: x y r; --columns names them)"),
    "bare.txt": ("1 2 3\n1 2 4\n", "no diameters or radii in it: give --diameter"),
    "cut.dump": (FORMATS["lammps.dump"][:-30], "the file ends inside 'ITEM: ATOMS'"),
    "none.dump": (frame_text(3, [], np.zeros((0, 3))), "there is no grain in timestep 3"),
    "radius.dump": (FORMATS["lammps.dump"].replace("id x y z", "id x y w"), "column 'z' is missing"),
    "cut.data": (FORMATS["lammps.data"][:-10], "line 21: expected 7 columns"),
    "fewer.data": (FORMATS["lammps.data"].replace("10 atoms", "11 atoms"), "10 of 11 atoms; the file is cut"),
    "style.data": (FORMATS["lammps.data"].replace("# sphere", "# atomic"), "atoms of style 'atomic', where 'sphere' is wanted"),
    "no-atoms.data": ("title\n\n3 atoms\n", "no section 'Atoms'"),
    "twice.data": (FORMATS["lammps.data"].replace("\n5 1 1", "\n4 1 1"), "grain id 4 stands twice"),
    "number.data": (FORMATS["lammps.data"].replace("5 1 1 2600", "5 1 one 2600"), "column 'diameter' is no number: 'one'"),
}


@pytest.mark.parametrize("name", DAMAGED)
def test_damaged_files_are_refused(tmp_path, monkeypatch, capsys, name):
    text, reason = DAMAGED[name]
    line = refusal(monkeypatch, capsys, write_text(tmp_path / name, text), *BOX, "-o", tmp_path / "out")
    assert reason in line and name in line
    assert not (tmp_path / "out").exists()


def test_cut_gzip_and_no_file(tmp_path, monkeypatch, capsys):
    whole = gzip.compress((FORMATS["lammps.data"] * 200).encode())
    (tmp_path / "cut.gz").write_bytes(whole[:len(whole) // 2])
    assert "compressed data" in refusal(monkeypatch, capsys, tmp_path / "cut.gz", *BOX, "-o", tmp_path)
    assert "no such file" in refusal(monkeypatch, capsys, tmp_path / "absent", *BOX, "-o", tmp_path)


@pytest.mark.parametrize("words, reason", [
    ("--box -3 3 -3 3", "the following arguments are required: --orifice"),
    ("--orifice 1", "one of the arguments --fit --box --cylinder --cone --walls is required"),
    ("--box 3 -3 -3 3 --orifice 1", "--box 3 -3 -3 3: these must be in increasing order"),
    ("--box -3 3 -3 3 --orifice 0 1", "--orifice: x y z R, or R alone"),
    ("--box -3 3 -3 inf --orifice 1", "argument --box: 'inf' must be a finite number"),
    ("--cylinder 0 0 -3 --orifice 1", "--cylinder 0 0 -3"),
    ("--cone 0 0 3 2 5 --orifice 1", "--cone 0 0 3 2 5"),
    ("--fit box --orifice 1 --gravity up", "--gravity up: an axis, such as -y"),
    ("--fit box --orifice 1 --gravity 0 0 0", "--gravity 0 0 0: an axis"),
    ("--box -3 3 -3 3 --orifice 1 --floor low", "--floor low: a height, or auto"),
    ("--box -3 3 -3 3 --orifice 1 --overlap 0.05", "--overlap 0.05: must be below 0.03 d"),
    ("--box -3 3 -3 3 --orifice 1 --scale 2", "--scale: give --g, too"),
    ("--box -3 3 -3 3 --orifice 1 --outflow -2", "argument --outflow: '-2' must be a positive number"),
    ("--box -3 3 -3 3 --orifice 1 --step 3", "--step is for dumps"),
    ("--box -3 3 -3 3 --orifice 1 --lammps-files /nowhere", "no load_spot.lmp and glass-beads.lmp in /nowhere: --lammps-files names"),
    ("--walls sphere --orifice 1", "--orifice: give x y z R where the walls are given by --walls"),
    ("--box -1.2 3 -3 3 --orifice 1", "3 grains stick out of the walls or the base by more than 0.3 d, such as grain 1 at -1.5 -1.5 0.5 by 0.80 d"),
    ("--box -3 3 -3 3 --orifice 0.5 --shift 0 0 -0.4", "stick out of the walls or the base"),
    ("--box -3 3 -3 3 --orifice 4", "--orifice 0 0 0 4 (x y z R): reaches 1.00 d beyond the wall at x = -3"),
    ("--box -3 3 -3 3 --orifice 0 2.5 0 1", "--orifice 0 2.5 0 1 (x y z R): reaches 0.50 d beyond the wall at y = 3"),
    ("--cylinder 0 0 3 --orifice 2 0 0 2", "reaches 1.00 d beyond the cylinder of radius 3, whose radius is 3 at its height"),
    ("--cone 0 0 3 5 4 --orifice 3.5", "reaches 0.50 d beyond the cone of 26.57 degrees, whose radius is 3 at its height"),
])
def test_options_that_are_refused(tmp_path, monkeypatch, capsys, words, reason):
    source = write_text(tmp_path / "bare.txt", rows_text(TEN, 0.5))
    assert reason in refusal(monkeypatch, capsys, source, *words.split(), "-o", tmp_path / "out")


def test_an_outlet_unlike_the_mouth_is_told(tmp_path):
    source = write_text(tmp_path / "bare.txt", rows_text(TEN, 0.5))
    for words, said in (("--cone 0 0 3 5 4 --orifice 2", "the cone's radius is 3 at the outlet's height, 1.00 d more than the outlet's"),
                        ("--cone 0 0 3 5 4 --orifice 0 0 -2.5 3", "the lowest grain is 2.5 d above the outlet: is that its height?"),
                        ("--cone 0 0 3 5 4 --orifice 3", "")):
        done = script("import_packing.py", source, *words.split(), "-o", tmp_path / "out")
        assert done.returncode == 0 and done.stdout.endswith(f"\ntry: spot-check {tmp_path}/out/in.spot\n")
        assert [said in line for line in done.stderr.splitlines() if "grains of 1 m" not in line] == [True] * bool(said)


def test_the_exit_status_is_1(tmp_path):
    done = script("import_packing.py", tmp_path / "absent", *BOX)
    assert done.returncode == 1 and done.stderr.count("\n") == 1
