# SPDX-License-Identifier: GPL-2.0-or-later
"""Pour and drain a hopper of 800 grains through all that its decks write, and the errors for input that does not fit."""

import json
import math

import numpy as np
import pytest

from liggghts_runs import DIAMETER, TAU, read_dump, run, run_ok

# Few grains between round walls take long to rest: they need not here.
HOPPER = {"angle": 45, "grains": 800, "width": 16, "pour_height": 40, "flux": 4000, "rest": 1, "python": "python3"}


@pytest.fixture(scope="module")
def hopper(tmp_path_factory):
    """Output folder of a pour and a drainage of 8 tau."""
    out = tmp_path_factory.mktemp("hopper")
    run_ok("hopper", "in.pour", out=out, **HOPPER)
    run_ok("hopper", "in.drain", out=out, time=8 * TAU, **{**HOPPER, "rest": 0})
    return out


def beyond_walls(columns):
    """How far the centre of a grain comes closer to the wall than its radius, at most (d); of those above the outlet."""
    radius, z = np.hypot(columns["x"], columns["y"]) / DIAMETER, columns["z"] / DIAMETER
    cone = (4 + z - radius) * math.cos(math.pi / 4)  # 45 degrees
    return (0.5 - np.minimum(cone, 8 - radius))[z > 0.5].max()


def test_grains_stay_inside_and_leave_through_the_outlet(hopper):
    [(_, first)], [(_, last)] = (read_dump(hopper / "drain" / f"drain.{step}.dump") for step in (0, 40000))
    assert len(first["id"]) == 800
    assert np.count_nonzero(last["z"] > 0) < 700
    # The mesh has 96 sides around the round walls.
    assert beyond_walls(first) < 0.02 and beyond_walls(last) < 0.02


def test_the_scene_tells_the_hopper(hopper):
    scene = json.loads((hopper / "drain" / "scene.json").read_text())
    assert scene["cone_height"] == pytest.approx(4 * DIAMETER)
    assert scene["cylinder_radius"] == pytest.approx(8 * DIAMETER)
    assert scene["orifice_radius"] == pytest.approx(4 * DIAMETER)
    assert scene["format"] == 1 and scene["cone_angle"] == 45 and scene["grains"] == 800


def test_a_packing_goes_on_over_a_flat_base(hopper, tmp_path):
    """The grains of the cone, on a plane with a hole: from a data file."""
    flat = {**HOPPER, "angle": 90, "rest": 0, "out": tmp_path}
    said = run_ok("hopper", "in.from_data", data=hopper / "packed.data", settle=0.2, **flat)
    assert "800 grains of" in said
    run_ok("hopper", "in.drain", time=4 * TAU, **flat)
    [(_, last)] = read_dump(tmp_path / "drain" / "drain.20000.dump")
    radius, z = np.hypot(last["x"], last["y"]) / DIAMETER, last["z"] / DIAMETER
    assert 400 < np.count_nonzero(z > 0) < 800
    # Nobody goes through the base beside the hole: what left is still below it, within 45 degrees of its rim.
    assert (z[(radius > 4.5) & (z > -1)] > 0.4).all() and (radius < 8).all()
    assert json.loads((tmp_path / "drain" / "scene.json").read_text())["cone_height"] == pytest.approx(0, abs=1e-12)


def test_grains_come_in_again_above_the_bed(hopper, tmp_path):
    (tmp_path / "packed.restart").write_bytes((hopper / "packed.restart").read_bytes())
    again = {**HOPPER, "rest": 0, "out": tmp_path}
    run_ok("hopper", "in.recirculate", tau_of_flow=8, **again)
    frames = [frame for step in range(0, 40001, 10000) for _, frame in read_dump(tmp_path / "recirculate" / f"drain.{step}.dump")]
    assert all((frame["id"] == frames[0]["id"]).all() and len(frame["id"]) == 800 for frame in frames)
    rises = np.diff([frame["z"] for frame in frames], axis=0) / DIAMETER
    # About 50 leave in a tau; each comes in 20 d above the bed, and none rises otherwise.
    assert 150 < np.count_nonzero(rises > 10) < 600
    assert all(beyond_walls(frame) < 0.03 and (frame["z"] > -6 * DIAMETER).all() for frame in frames)


def test_grains_come_in_again_below_the_ends_of_the_walls(hopper, tmp_path):
    low = {**HOPPER, "rest": 0, "pour_height": 20, "out": tmp_path}
    run_ok("hopper", "in.from_data", data=hopper / "packed.data", settle=0.1, **low)
    said = run("hopper", "in.recirculate", tau_of_flow=1, **low)
    assert "raise pour_height" in said.stdout + said.stderr


@pytest.mark.parametrize("deck, change, said", [
    ("in.pour", {"angle": 91}, "angle is 91 degrees"),
    ("in.pour", {"orifice": 16}, "orifice is 16 d"),
    ("in.pour", {"grains": 20000}, "raise pour_height"),
    ("in.pour", {"flux": 40000}, "more than 0.2"),
    ("in.from_data", {"settle": -1}, "settle is -1 tau"),
    ("in.from_data", {"data": "none.data"}, "no data file none.data"),
    ("in.drain", {}, "run in.pour first"),
    ("in.recirculate", {}, "run in.pour first")])
def test_mistakes_are_named(tmp_path, deck, change, said):
    done = run("hopper", deck, out=tmp_path, **{**HOPPER, **change})
    assert said in done.stdout + done.stderr
