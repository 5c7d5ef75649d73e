# SPDX-License-Identifier: GPL-2.0-or-later
"""render.py on plugs that fall: what is drawn where and in which colour, what is kept, and what is refused."""

import json
import math
import os
import shutil
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from conftest import ANALYSIS, script
from synthetic import SCENE, frame_text, plug, write_plug_flow, write_text

from spot_analysis.base.errors import AnalysisError
from spot_analysis.reading.container import Container
from spot_analysis.reading.hopper import Hopper
from spot_analysis.reading.packing_file import read_packing
from spot_analysis.rendering.colouring import COLOURINGS
from spot_analysis.rendering.drawing import View, draw
from spot_analysis.rendering.kept_pictures import load_pictures, save_pictures
from spot_analysis.rendering.pictures import Picture, Reel, at_common_times, take_pictures
from spot_analysis.rendering.source import Run
from spot_analysis.statistics.voronoi_cells import cells_in_container, cells_in_hopper

TIMES = range(0, 10, 2)


def always(_):
    return True


def silent(*_):
    pass


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """Plugs that fall by half a layer and by two in 2 tau; the second has no snapshot at 4 tau."""
    folder = tmp_path_factory.mktemp("runs")
    return [write_plug_flow(folder / "slow", 0.5, TIMES), write_plug_flow(folder / "fast", 2.0, [0, 2, 6, 8])]


def reel_of(path, colour, slab=None, wanted=always, layer=10):
    run = Run("run", path)
    return take_pictures(run, colour, COLOURINGS[colour](run, layer), slab, wanted, silent)


def bare(folder, columns="id x y z radius", scene=None, **extra):
    """A folder with three grains, of radius 0.002, in two snapshots, the second 0.001 lower."""
    folder.mkdir()
    points = np.array([[0, 0, 0.001], [0.004, 0, 0.001], [0, 0.02, 0.01]])
    for step in (0, 100):
        text = frame_text(step, [1, 2, 3], points - [0, 0, step * 1e-5], columns, extra={"radius": [0.002] * 3, **extra}.items())
        write_text(folder / f"a.{step}.dump", text)
    if scene:
        (folder / "scene.json").write_text(json.dumps(scene))
    return folder


def test_grains_at_the_front_wall_keep_the_layer_they_started_in(runs):
    reel = reel_of(runs[1], "layer")
    start = plug()
    front = start[:, 1] < 1 - SCENE["half_depth_y"]
    for picture, time in zip(reel.pictures, (0, 2, 6, 8)):
        left = front & (start[:, 2] > time * 0.99)
        assert len(picture.x) == left.sum() > 1000
        drawn = sorted(zip(picture.x.round(6), picture.z.round(6), picture.values))
        expected = sorted(zip(start[left, 0].round(6), (start[left, 2] - time * 0.99).round(6), np.floor(start[left, 2] / 10)))
        assert np.allclose(drawn, expected)


def test_speed_is_the_drop_over_the_time(runs):
    first, *later = reel_of(runs[1], "speed").pictures
    assert np.isnan(first.values).all()
    for picture in later:
        assert np.allclose(picture.values, 0.99, rtol=1e-5)


def test_speed_of_a_new_grain_is_unknown(tmp_path):
    write_text(tmp_path / "a.dump", frame_text(0, [1, 2], [[0, 0, 0], [2, 0, 0]]) + frame_text(4, [2, 3], [[2, 0, -1], [4, 0, 0]]))
    run = Run("run", str(tmp_path), diameter=1)
    picture = take_pictures(run, "speed", COLOURINGS["speed"](run, 10), None, always, silent).pictures[1]
    assert dict(zip(picture.x, picture.values))[2] == 0.25 and math.isnan(dict(zip(picture.x, picture.values))[4])


def test_packing_fraction_is_that_of_the_whole_packing(runs):
    """The slab's cells are made of grains near it only; they must be those of all grains."""
    picture = reel_of(runs[0], "packing", (-1, 1)).pictures[0]
    start = plug()
    everywhere = np.pi / 6 / cells_in_container(start, Container(10, 4, 12))
    expected = {(x.round(4), z.round(4)): one for (x, y, z), one in zip(start, everywhere) if -1 <= y < 1}
    drawn = {(x.round(4), z.round(4)): one for x, z, one in zip(picture.x, picture.z, picture.values)}
    inner = [place for place in drawn if 3 < place[1] < 70]
    assert len(inner) > 500
    assert np.allclose([drawn[place] for place in inner], [expected[place] for place in inner])


def test_packing_fraction_without_walls(tmp_path):
    """A simple cubic crystal: pi/6 inside, unknown at the walls that nobody told."""
    points = np.array([[i, j, k] for i in range(7) for j in range(7) for k in range(7)], dtype=float)
    write_text(tmp_path / "a.dump", frame_text(0, np.arange(343) + 1, points))
    run = Run("run", str(tmp_path), diameter=1)
    picture = take_pictures(run, "packing", COLOURINGS["packing"](run, 10), None, always, silent).pictures[0]
    inside = (picture.x > 0) & (picture.x < 6) & (picture.z > 0) & (picture.z < 6)
    assert np.allclose(picture.values[inside], math.pi / 6) and np.isnan(picture.values[~inside]).all()


def test_packing_fraction_of_unequal_grains_is_refused(tmp_path):
    done = script("render.py", bare(tmp_path / "a", radius=[0.002, 0.002, 0.003]), "--colour", "packing", "-o", tmp_path / "x.png")
    assert done.returncode == 1 and "differ in size by more than 1 %" in done.stderr


def test_sizes_come_from_the_dump(tmp_path):
    for columns, extra in (("id x y z radius", {}), ("id x y z diameter", {"diameter": [0.004] * 3})):
        grains = next(Run("run", str(bare(tmp_path / columns[-8:].strip(), columns, **extra))).snapshots())
        assert np.allclose(grains.diameters, 1) and np.allclose(grains.positions[1], [1, 0, 0.25])


def test_slab_and_the_order_of_drawing(tmp_path):
    folder = str(bare(tmp_path / "a"))
    assert reel_of(folder, "layer", (4, 6)).pictures[0].z == pytest.approx([2.5])
    assert len(reel_of(folder, "layer").pictures[0].x) == 0  # from 1.5 to 3.5 d, in the middle of 0 and 5 d
    every = reel_of(folder, "layer", (-1, 6)).pictures[0]
    assert every.z[0] == pytest.approx(2.5) and len(every.x) == 3  # y = 5 d is far, so first


def test_a_silo_periodic_along_y_is_drawn(tmp_path):
    scene = {key: value for key, value in SCENE.items() if key != "half_depth_y"}
    folder = bare(tmp_path / "a", scene={**scene, "half_period_y": 8.0})
    run = Run("run", str(folder))
    assert run.container.half_depth == 8 and not run.has_front


def test_a_scene_of_units_only(tmp_path):
    """Times in tau and no walls, so that a hopper can be drawn beside DEM's."""
    units = {"diameter": 0.004, "gravity": 10.0, "timestep": 0.01}
    run = Run("run", str(bare(tmp_path / "a", "id x y z", units)))
    assert run.container is None and not run.has_front
    start, end = run.snapshots()
    assert (start.time, end.time) == (0, pytest.approx(50)) and np.allclose(start.positions[1], [1, 0, 0.25])
    done = script("render.py", bare(tmp_path / "b", scene={**units, "half_width_x": 1.0}), "-o", tmp_path / "x.png")
    assert done.returncode == 1 and "scene key 'half_depth_y' is missing" in done.stderr


HOPPER = Hopper(4.0, 10.0, 15.0)
HOPPER_SCENE = {"diameter": 0.004, "gravity": 10.0, "timestep": 0.01, "orifice_radius": 0.016, "cylinder_radius": 0.04, "cone_height": 0.06}


def test_a_hopper_is_told_by_its_scene(tmp_path):
    run = Run("run", str(bare(tmp_path / "a", scene={**HOPPER_SCENE, "program": "any", "cone_angle": 21.8})))
    assert np.allclose(list(vars(run.container).values()), [4, 10, 15, 0]) and not run.has_front
    assert reel_of(run.path, "layer", (4.5, 6)).container.section == 4.5 and reel_of(run.path, "layer").container.section == 1.5
    save_pictures(tmp_path / "kept.npz", reel_of(run.path, "layer", (4.5, 6)))
    assert load_pictures("run", str(tmp_path / "kept.npz"), always).container == replace(run.container, section=4.5)
    done = script("render.py", bare(tmp_path / "b", scene={**HOPPER_SCENE, "cone_height": -1}), "-o", tmp_path / "x.png")
    assert done.returncode == 1 and "'cone_height' must be a positive number" in done.stderr


def test_walls_of_a_hopper():
    """In the middle straight lines; beside it where the slab is widest, a hyperbola; nothing beyond the cylinder."""
    for x, z in HOPPER.lines(30):
        assert np.allclose(abs(x), np.minimum(4 + 6 * z / 15, 10)) and (z[0], z[-1]) == (0, 30)
    for x, z in HOPPER.cut((-8, -6)).lines(30):
        assert np.allclose(np.hypot(x, -6), np.minimum(4 + 6 * z / 15, 10)) and (z[0], z[-1]) == (5, 30)
    assert HOPPER.cut((-8, -6)).half_width == 8 and HOPPER.cut((-1, 3)) == HOPPER.cut(None) == HOPPER
    assert HOPPER.cut((11, 12)).lines(30) == []
    picture = Picture(0.0, *[np.array([5.0])] * 4)
    image = np.asarray(draw([("", picture, HOPPER, "")], View((-12, 12), (-1, 20), 436, (0, 1)), "layer").convert("L"))
    rows = [430 - round((z + 1) * 400 / 21) for z in (0.5, 7.5, 18)]
    for row, width in zip(rows, (4.2, 7, 10)):
        black = np.flatnonzero(image[row] < 128)
        assert np.ptp(black) * 21 / 400 == pytest.approx(2 * width, abs=0.2)


def test_packing_fraction_at_the_walls_of_a_hopper():
    """Cells of the grains between two heights fill what is between the walls there."""
    grains = read_packing(str(ANALYSIS.parent / "examples" / "own-hopper" / "packing.data.gz")).positions / 0.003
    cells = cells_in_hopper(grains, HOPPER)
    z = grains[:, 2]
    radius = lambda height: min(4 + 6 * height / 15, 10)
    for low, high in ((3, 12), (17, 24)):
        between = (z > low) & (z < high)
        volume = np.pi * (high - low) * (radius(low)**2 + radius(low) * radius(high) + radius(high)**2) / 3
        assert cells[between].sum() == pytest.approx(volume, rel=0.01)
    images = HOPPER.images(grains, 1.0)
    assert (np.hypot(*images.T[:2]) > np.minimum(4 + 6 * images[:, 2] / 15, 10) - 0.02).all()


def test_a_grain_is_drawn_in_its_place_and_colour():
    picture = Picture(0.0, np.array([2.0, -3.0]), np.array([4.0, 8.0]), np.array([1.0, 2.0]), np.array([1.0, np.nan]),
                      np.array([[-3.0, 3.0]]))
    view = View((-5, 5), (0, 10), 436, (0, 1), 1.5)  # panel: 400 pixels, so 40 a d
    image = draw([("title", picture, None, "speed")], View((-5, 5), (0, 10), 436, (0, 1)), "layer")
    assert image.size == (412, 436)

    def pixel(image, x, z):
        return image.getpixel((round(6 + (x + 5) * 40), round(436 - 6 - z * 40)))

    assert pixel(image, 2, 4) == (0xf4, 0xa2, 0x59)  # layer 1
    assert pixel(image, 2.4, 4) == (0xf4, 0xa2, 0x59) and pixel(image, 2.6, 4) == (255, 255, 255)
    assert pixel(image, -3, 8) == pixel(image, -3, 8.9) == (179, 179, 179)  # unknown
    assert pixel(image, -3, 4.5) == (255, 255, 255)
    spots = draw([("title", picture, None, "speed")], view, "layer")
    assert pixel(spots, -3, 4.3) == pixel(spots, -3, 3) != (255, 255, 255) and pixel(spots, -3, 4.6) == (255, 255, 255)


def test_common_times(runs):
    reels = [reel_of(path, "layer") for path in runs]
    assert [[one.time for one in row] for row in at_common_times(reels)] == [[0, 0], [2, 2], [6, 6], [8, 8]]
    with pytest.raises(AnalysisError, match="run: no scene.json"):
        at_common_times([reels[0], Reel("run", "layer", None, None, False, reels[1].pictures)])


def test_kept_pictures_come_back(runs, tmp_path):
    reel = reel_of(runs[0], "speed")
    save_pictures(tmp_path / "kept.npz", reel)
    again = load_pictures("run", str(tmp_path / "kept.npz"), lambda time: time > 3)
    assert (again.colour, again.colour_label, again.container, again.tau) == (reel.colour, reel.colour_label, reel.container, True)
    assert [picture.time for picture in again.pictures] == [4, 6, 8]
    for one, other in zip(again.pictures, reel.pictures[2:]):
        assert len(one.x) == len(other.x) > 1000 and (np.diff(one.z) >= 0).all()
        for name, tolerance in (("x", 0.0051), ("z", 0.0051), ("diameters", 0.0051), ("values", 0.001)):
            assert np.allclose(np.sort(getattr(one, name)), np.sort(getattr(other, name)), atol=tolerance)


def test_statistics_have_the_same_picture(runs, tmp_path):
    assert script("measure.py", runs[0], "-o", tmp_path / "a.npz").returncode == 0
    stored = load_pictures("run", str(tmp_path / "a.npz"), always).pictures
    assert [picture.time for picture in stored] == [0]
    fresh = reel_of(runs[0], "layer").pictures[0]
    assert sorted(zip(stored[0].x.round(2), stored[0].z.round(2), stored[0].values)) == pytest.approx(
        sorted(zip(fresh.x.round(2), fresh.z.round(2), fresh.values)), abs=0.011)


@pytest.mark.parametrize("name, frames", [("a.gif", 4), ("a.webp", 4), ("a.png", 1)])
def test_animations_and_pictures(runs, tmp_path, name, frames):
    done = script("render.py", f"slow={runs[0]}", f"fast={runs[1]}", "-o", tmp_path / name, "--height", 200, "--fps", 5)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    with Image.open(tmp_path / name) as image:
        assert getattr(image, "n_frames", 1) == frames and image.height == 200
        if frames > 1:
            image.seek(1)
            image.load()
            assert image.info["duration"] == 200


def test_png_frames_at_chosen_times(runs, tmp_path):
    done = script("render.py", runs[0], "-o", tmp_path / "frames", "--height", 200, "--from", 2, "--every", 2)
    assert done.returncode == 0, done.stderr
    assert sorted(os.listdir(tmp_path / "frames")) == ["frame.0000.png", "frame.0001.png"]
    done = script("render.py", runs[0], "-o", tmp_path / "one", "--height", 200, "--times", 4, 8)
    assert len(os.listdir(tmp_path / "one")) == 2


@pytest.mark.skipif(not shutil.which("ffmpeg"), reason="no ffmpeg; on Debian: apt install ffmpeg")
def test_mp4(runs, tmp_path):
    done = script("render.py", runs[0], "-o", tmp_path / "a.mp4", "--height", 201)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "a.mp4").read_bytes()[4:8] == b"ftyp"


def test_mp4_without_ffmpeg(runs, tmp_path):
    done = subprocess.run([sys.executable, "-B", str(ANALYSIS / "render.py"), runs[0], "-o", str(tmp_path / "a.mp4")],
                          capture_output=True, text=True, env={**os.environ, "PATH": str(tmp_path)})
    assert done.returncode == 1 and "MP4 needs the program ffmpeg" in done.stderr and done.stderr.count("\n") == 1


def test_spots_of_dump_local(tmp_path):
    folder = bare(tmp_path / "a")
    columns = " ".join(f"f_drain[{number}]" for number in range(1, 7))
    (folder / "spots.dump").write_text("".join(
        f"ITEM: TIMESTEP\n{step}\nITEM: NUMBER OF ENTRIES\n{len(rows)}\nITEM: BOX BOUNDS ff ff ff\n0 1\n0 1\n0 1\nITEM: ENTRIES {columns}\n"
        + "".join(f"7 {x} 0 {z} 12 1 \n" for x, z in rows) for step, rows in ((0, []), (100, [(0.004, 0.008), (0, 0.012)]))))
    first, second = reel_of(str(folder), "layer", (-1, 1)).pictures
    assert len(first.spots) == 0 and np.allclose(second.spots, [[1, 2], [0, 3]])
    assert len(reel_of(str(folder), "layer", (4, 6)).pictures[1].spots) == 0
    done = script("render.py", folder, "--spots", 2, "--slice", -1, 6, "-o", tmp_path / "x.png")
    assert done.returncode == 0, done.stderr
    assert script("render.py", folder, "--slice", -1, 6, "-o", tmp_path / "y.png").returncode == 0
    assert (tmp_path / "x.png").read_bytes() != (tmp_path / "y.png").read_bytes()
    (folder / "spots.dump").write_text(f"ITEM: TIMESTEP\n0\nITEM: NUMBER OF ENTRIES\n2\nITEM: ENTRIES {columns}\n1 2 3 4 5 6\n")
    done = script("render.py", folder, "-o", tmp_path / "x.png")
    assert done.returncode == 1 and "the file ends inside 'ITEM: ENTRIES' (1 of 2 lines)" in done.stderr


def test_vtk(runs, tmp_path):
    done = script("render.py", runs[1], "-o", tmp_path / "a.vtk", "--colour", "speed", "--from", 2, "--every", 2)
    assert done.returncode == 0, done.stderr
    assert sorted(os.listdir(tmp_path)) == ["a.0000.vtk", "a.0001.vtk"]
    data = (tmp_path / "a.0000.vtk").read_bytes()
    count = int((plug()[:, 2] > 1.98).sum())
    header, rest = data.split(f"POINTS {count} float\n".encode())
    assert header.startswith(b"# vtk DataFile Version 3.0\nt = 2\nBINARY\nDATASET POLYDATA\n")
    points = np.frombuffer(rest, ">f4", 3 * count).reshape(-1, 3)
    assert np.allclose(points, (plug() - [0, 0, 1.98])[plug()[:, 2] > 1.98], atol=1e-4)
    speeds = rest.split(b"SCALARS speed float 1\nLOOKUP_TABLE default\n")[1]
    assert len(speeds) == 4 * count + 1 and np.allclose(np.frombuffer(speeds, ">f4", count), 0.99, rtol=1e-4)


@pytest.mark.parametrize("words, message", [
    (["a", "-o", "x.tiff"], "unknown kind of picture '.tiff'"),
    (["a"], "give --output or --keep"),
    (["a", "-o", "none/x.png"], "no folder"),
    (["none", "-o", "x.png"], "none: no such file"),
    (["a", "a", "-o", "x.vtk"], "VTK wants the dumps of one run"),
    (["a", "a", "--keep", "x.npz"], "--keep wants one run"),
    (["a", "-o", "x.png", "--slice", "1", "1"], "--slice 1 1: the first must be below the second"),
    (["a", "-o", "x.png", "--slice", "100", "101"], "a: no grain between y = 100 and 101 d (--slice); they are at 0 to 5 d"),
    (["a", "-o", "x.png", "--height", "20"], "--height 20 must be 100 to 4000 pixels"),
    (["a", "-o", "x.png", "--every", "0"], "--every 0 must be 1 or more"),
    (["a", "-o", "x.png", "--times", "7"], "a: no snapshot at a time that was asked for"),
    (["a", "-o", "x.png", "--times", "0", "7", "100"], "--times 7: no such snapshot, or not of all runs"),
    (["a", "-o", "x.vtk", "--times", "7"], "a: no snapshot at a time that was asked for"),
    (["plain", "-o", "x.png"], "plain: the grains' diameter is not known"),
    (["a", "-o", "x.png", "--spots", "2"], "--spots: no live spots"),
    (["bad.npz", "-o", "x.png"], "bad.npz: neither pictures kept by render.py nor statistics"),
])
def test_refusals(tmp_path, words, message):
    bare(tmp_path / "a")
    bare(tmp_path / "plain", "id x y z")
    (tmp_path / "bad.npz").write_text("no")
    done = subprocess.run([sys.executable, "-B", str(ANALYSIS / "render.py"), *words], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 1 and done.stdout == ""
    assert done.stderr.startswith("error: ") and message in done.stderr and done.stderr.count("\n") == 1
