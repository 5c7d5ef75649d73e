# SPDX-License-Identifier: GPL-2.0-or-later
"""check_deck.py with a program in place of lmp: its table, what it marks, its picture, and what it refuses. The real one: tests/lammps."""

import json
import math
import sys

import numpy as np
import pytest
from PIL import Image

from conftest import script

from spot_analysis.base.errors import AnalysisError
from spot_analysis.report.deck_numbers import MOVE, numbers, table, tau_of

GRAIN = math.pi / 6
RUN = {"format": 1, "units": "lj", "grains": 1000, "diameter": 1.0, "timestep": 0.5, "window": 0.1, "steps": 40, "memory": 2000000, "threads": 1,
       "time_ordered": False, "profile": "parabolic", "radius": 3.53, "influence": 1.5e-3, "fixed_volume": 77, "step_height": 1.2, "speed": 6.0,
       "diffusion": 1.47, "dilation": 0, "spot_volume": 0.1155 * GRAIN, "enclosed": 81.6 * GRAIN, "spots": 500, "moves_per_time": 1000.0,
       "walked": 20.0, "steady": True,
       "outlets": [{"name": "a hole", "centre": [0, 0, 0], "half_widths": [4, 4], "births": 433, "outflow": 50.0}],
       "slices": [{"across": axis, "at": 0.0, "low": [-6, -10], "high": [6, 20], "inside": ["000000"] * 10 + ["011110"] * 20,
                   "grains": [[0, 0.5], [1, 2]]} for axis in "yx"],
       "ways": [[[0, 0, -3], [0, 1, 5], [2, 1, 9]]], "live": [[0.5, 0.5, 3]]}


def rows(**changes):
    found = {}
    for row in numbers({**RUN, **changes}, 1.0):
        found.setdefault(row.name, []).append(row)
    return found


def test_numbers():
    found = rows()
    assert found["outflow"][1].value == 50 and found["empty after"][0].value == 20 and found["length of the run"][0].value == 20
    assert found["volume of a spot V_s"][0].value == pytest.approx(0.1155) and found["grains in a spot"][0].value == pytest.approx(81.6)
    assert found["narrowest outlet"][0].value == 8 and found["climb of a spot in it"][0].value == pytest.approx(0.6)
    assert found["processor time"][0].value == pytest.approx(MOVE * 1000 * 20)
    assert all(row.fits is not False for same in found.values() for row in same)


@pytest.mark.parametrize("change, marked", [
    ({"radius": 2.6}, "radius of spots R_s"), ({"speed": 25.0}, "speed v_s"), ({"dilation": 0.03}, "dilation c_0"), ({"window": 0.5}, "climb of a spot in it"),
    ({"outlets": [{**RUN["outlets"][0], "half_widths": [2.5, 4]}]}, "narrowest outlet"),
    ({"outlets": [{**RUN["outlets"][0], "half_widths": [9, 8]}]}, "narrowest outlet"),
    ({"smallest": 0.7, "largest": 1.4}, "smallest grain"), ({"smallest": 0.9, "largest": 1.8}, "largest grain")])
def test_what_is_outside_is_marked(change, marked):
    found = rows(**change)
    assert found[marked][0].fits is False
    text = table([row for same in found.values() for row in same])
    assert any(line.startswith(f"! {marked} ") for line in text.splitlines()) and marked in text.splitlines()[-1]


@pytest.mark.parametrize("half_width, note", [(4.0005, "calibrations and DEM"), (7.5, "compared with DEM; calibrations have 6.5 to 8")])
def test_outlets_that_were_compared(half_width, note):
    (row,) = rows(outlets=[{**RUN["outlets"][0], "half_widths": [half_width] * 2}])["narrowest outlet"]
    assert row.fits and row.note.startswith(note)


def test_sizes_that_were_compared():
    small = 9**(1 / 3) / 16**(1 / 3)  # eight grains, and one twice as wide, whose mean volume is that of d
    found = rows(smallest=round(small, 4), largest=round(2 * small, 4), critical=0.655)
    assert found["largest over smallest grain"][0].value == pytest.approx(2, rel=1e-3)
    assert all(row.fits is not False for same in found.values() for row in same)
    assert "mixtures" in found["critical fraction phi_c"][0].note
    equal = rows(smallest=1.0, largest=1.0, critical=0.62)
    assert "smallest grain" not in equal and "mixtures" not in equal["critical fraction phi_c"][0].note
    assert rows(critical=0)["critical fraction phi_c"][0].note.startswith("0: off") and "critical fraction phi_c" not in rows()


def test_what_makes_beds_flow_as_dems_is_told_in_diameters():
    found = rows(diameter=0.003, full_strain=200 / 3, spread=0)
    strain, spread = found["strain of full exchange s_1"][0], found["spread by shear B"][0]
    assert strain.value == pytest.approx(0.2) and strain.unit == "1/d" and "0.2" in strain.note
    assert spread.value == 0 and spread.note.startswith("0: off")


def test_what_recirculates_is_never_empty():
    found = rows(recirculates=True)
    assert "empty after" not in found and found["turned over every"][0].value == 20
    assert "empties" not in found["processor time"][0].note and "empties" in rows()["processor time"][0].note


def test_an_outlet_each_and_no_cost_in_the_order_of_time():
    two = rows(outlets=RUN["outlets"] * 2)
    assert two["outflow"][1].value == 100 and two["  through outlet 2"][0].value == 50
    assert "processor time" not in rows(time_ordered=True)


def test_tau_needs_gravity():
    assert tau_of({"units": "si", "diameter": 0.003}) == pytest.approx(0.01749, rel=1e-3)
    assert tau_of({"units": "metal", "diameter": 4}, 1.0) == 2
    for gravity in (None, -1.0, math.nan):
        with pytest.raises(AnalysisError, match="--g: give"):
            tau_of({"units": "metal", "diameter": 4}, gravity)


def program(folder, code):
    """A command in place of lmp; in it, v has the variables of the command line."""
    path = folder / "lmp.py"
    path.write_text("import json, sys\nw = sys.argv\nv = {w[k + 1]: w[k + 2] for k in range(len(w)) if w[k] == '-var'}\n" + code)
    return f"{sys.executable} {path}"


@pytest.fixture
def deck(tmp_path):
    (tmp_path / "deck").mkdir()
    (tmp_path / "deck" / "in.deck").write_text("run 1\n")
    return tmp_path / "deck" / "in.deck"


def test_the_picture_has_what_the_title_says(tmp_path, deck):
    (tmp_path / "run.json").write_text(json.dumps(RUN))
    lmp = program(tmp_path, f"assert v['threads'] == '2' and w[2] == 'in.deck'\nprint('WARNING: fix spot: narrow (../fix_spot.cpp:5)')\n"
                            f"open(v['spot_dry_run'], 'w').write(open({str(tmp_path / 'run.json')!r}).read())")
    done = script("check_deck.py", deck, "-o", tmp_path / "a.png", "--lmp", lmp, "--var", "threads", 2)
    assert done.returncode == 0 and done.stderr == "warning: fix spot: narrow\n"
    assert "\n  grains                 1000 " in done.stdout
    pixels = np.asarray(Image.open(tmp_path / "a.png").convert("RGB")).reshape(-1, 3)
    for colour in ((0x8d, 0x99, 0xa6), (0xf1, 0xd9, 0xb0), (0x2a, 0x9d, 0x4a)):  # walls, grains, outlets
        assert np.count_nonzero((abs(pixels.astype(int) - colour) < 3).all(axis=1)) > 30


@pytest.mark.parametrize("code, reason", [
    ("print('ERROR: fix spot: grain 5 is outside (/tmp/x/fix_spot.cpp:371)\\nLast command: run 5')\nsys.exit(1)",
     "in.deck: fix spot: grain 5 is outside\n"),
    ("print('ERROR on proc 0: no (src/a.cpp:3)')\nsys.exit(1)", "in.deck: no\n"),
    ("pass", "in.deck: ends without a run of a fix spot\n")])
def test_a_bad_deck_ends_with_one_line(tmp_path, deck, code, reason):
    done = script("check_deck.py", deck, "-o", tmp_path / "a.png", "--lmp", program(tmp_path, code))
    assert done.returncode == 1 and done.stdout == "" and done.stderr.startswith("error: ") and done.stderr.endswith(reason)
    assert done.stderr.count("\n") == 1 and not (tmp_path / "a.png").exists()


def test_bad_words(tmp_path, deck):
    for words, reason in (([tmp_path / "absent"], "no such file"), ([deck, "-o", "a.jpg"], "must end in .png"),
                          ([deck, "--lmp", "/absent/lmp"], "cannot run /absent/lmp")):
        done = script("check_deck.py", *words)
        assert done.returncode == 1 and reason in done.stderr and done.stderr.count("\n") == 1
