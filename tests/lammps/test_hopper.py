# SPDX-License-Identifier: GPL-2.0-or-later
"""examples/hoppers/in.hopper_spot, a short stretch of it, on its real packings."""

import json
import re

import pytest
import zstandard

from lammps_runs import needs_mpirun, on_ranks, run_example
from near_dem import assert_near_dem


def run_hopper(out, launcher=(), **variables):
    """The last snapshot of the deck, as bytes, and what the program said."""
    said = run_example("hoppers", "in.hopper_spot", out, launcher, **{"time": 0.035, **variables})
    return zstandard.open(out / "drain.4.dump.zst", "rb").read(), said


@needs_mpirun
@pytest.mark.parametrize("angle, height", [(30, 13.8564), (60, 4.6188)])
def test_the_deck_drains_both_hoppers(tmp_path, angle, height):
    outflow = {30: 86.4, 60: 61.4}[angle]
    one, _ = run_hopper(tmp_path / "one", angle=angle, outflow=outflow, time=0.174)
    scene = json.loads((tmp_path / "one" / "scene.json").read_text())
    assert scene["cone_height"] == pytest.approx(0.003 * height, rel=1e-5) and scene["grains"] == 12000
    assert int(one.split(b"\n")[3]) < 12000
    assert run_hopper(tmp_path / "two", launcher=on_ranks(2), angle=angle, threads=2, outflow=outflow)[0] == one
    # 10 tau. In the README: + 9 and + 10 % on the axis at 5 d, - 5 and - 1 % at 10 d, + 1 % in packing fraction; 5 % at first over the
    # shallow cone, whose bed has not dilated yet.
    assert_near_dem(tmp_path / "one", f"hoppers/dem-{angle}.json", (4, 10), {
        "outflow": 0.07, "speed_5d_r1.0d": 0.25, "speed_5d_r3.0d": 0.25, "packing_fraction": 0.06,
        **({"speed_10d_r1.0d": 0.20} if angle == 30 else {"speed_10d_r1.0d": 0.35})})


@pytest.mark.parametrize("angle, predicted", [(30, 115.7), (60, 78.7)])
def test_the_outflow_may_be_predicted(tmp_path, angle, predicted):
    """As was written down, in grains a tau, before DEM drained these hoppers."""
    _, said = run_hopper(tmp_path / "out", angle=angle, rate="beverloo 9.81 hopper 24")
    outflow = float(re.search("predicts an outflow of ([0-9.]+)", said).group(1))
    assert outflow * (0.003 / 9.81) ** 0.5 == pytest.approx(predicted, abs=0.06)
    assert f"half-angle of {angle} degrees" in said and "cones of less than 66" in said


def test_a_hopper_is_no_flat_base(tmp_path):
    _, said = run_hopper(tmp_path / "out", rate="beverloo 9.81")
    assert "Beverloo's law predicts an outflow of 4111" in said  # 71.9 a tau
    assert "end of a hopper with a half-angle of 30 degrees: Beverloo's law is for flat bases" in said
