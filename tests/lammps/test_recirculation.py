# SPDX-License-Identifier: GPL-2.0-or-later
"""Drained grains come in again: keyword recirculate."""

import numpy as np
import pytest

from lammps_runs import (BOX, FIX, LOAD_SPOT, OPENING, RATES, deck, error_of, lattice, needs_mpirun, on_ranks, positions, read_dump, run_ok,
                         run_text, thermo, write_data)
from test_come_and_go import hanging

FIX = FIX.replace("injection 100", "injection 12") + " volume 77 peratom yes"
COLUMNS = " ".join(f"f_drain[{k}]" for k in range(1, 6))
DUMP = f"""dump fates all custom 50 fates.dump id x y z vx vy vz ix iy iz {COLUMNS}
dump_modify fates sort id format float %.17g"""
TOP = "region top block -4 4 -3 3 13 18"
STEPS = 1500  # two turnovers


def circulate(folder, how="yes", fix=FIX, run=f"run {STEPS}", launcher=(), after=DUMP, **parts):
    """What the deck says, and the frames of its dump."""
    folder.mkdir(exist_ok=True)
    said = run_ok(deck(fix=f"{fix} recirculate {how}", run=run, after=after, **parts), folder, launcher=launcher)
    return thermo(said), read_dump(folder / "fates.dump")


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    folder = tmp_path_factory.mktemp("alone")
    return circulate(folder), (folder / "fates.dump").read_bytes()


def test_two_turnovers(alone):
    """No grain is lost or there twice, passages add up, and after the first turnover the bed stays as dense as it is then."""
    log, frames = alone[0]
    grains = len(lattice())
    assert (log["Atoms"] == grains).all()
    assert log["f_drain[3]"][-1] > 1.9 * grains and log["f_drain[6]"].max() < 0.05
    assert log["f_drain[4]"] == pytest.approx(log["f_drain[3]"] * np.pi / 6)
    fractions = []
    for step, frame in frames:
        assert frame["id"].tolist() == list(range(1, grains + 1))
        inside = positions(frame)
        assert abs(inside[:, 0]).max() < 4.55 and abs(inside[:, 1]).max() < 3.55
        fractions.append(((inside[:, 2] > 1.5) & (inside[:, 2] < 6)).sum() * np.pi / 6 / (10 * 8 * 4.5))
        assert frame["f_drain[5]"].sum() == log["f_drain[3]"][log["Step"] == step][-1]
    half = len(frames) // 2
    first, second = np.mean(fractions[half:3 * half // 2]), np.mean(fractions[3 * half // 2:])
    assert first > 0.54 and abs(second - first) < 0.01
    end = frames[-1][1]
    assert len(hanging(end, end["z"] > 5)) <= 2  # lower grains may be on their way out


def test_displacements_and_velocities_know_no_way_back_up(alone):
    _, frames = alone[0]
    (_, start), (_, end) = frames[0], frames[-1]
    fallen = -end["f_drain[3]"]
    stayed = end["f_drain[5]"] == 0
    assert stayed.any() and fallen[stayed] == pytest.approx((start["z"] - end["z"])[stayed], abs=1e-12)
    often = end["f_drain[5]"] >= 2
    assert often.any() and (fallen[often] > 8).all()
    assert abs(np.concatenate([[frame[f"v{name}"] for name in "xyz"] for _, frame in frames], axis=1)).max() < 10
    assert not any(end[f"i{name}"].any() for name in "xyz")


@needs_mpirun
@pytest.mark.parametrize("ranks, before", [(3, ""), (4, "processors 2 2 1"), (4, "comm_style tiled\nfix even all balance 5 1.0 rcb")])
def test_ranks(alone, tmp_path, ranks, before):
    """A grain that comes in again goes from one sub-domain to another, which need not be its neighbour."""
    text = deck(fix=f"{FIX} recirculate yes", run="run 500", after=DUMP)
    run_ok(text.replace("read_data packing.data", f"{before}\nread_data packing.data" if before.startswith("proc")
                        else f"read_data packing.data\n{before}"), tmp_path, launcher=on_ranks(ranks))
    bytes_here = (tmp_path / "fates.dump").read_bytes()
    assert alone[1].startswith(bytes_here) and bytes_here.count(b"TIMESTEP") == 11


@needs_mpirun
def test_restart(alone, tmp_path):
    """From two ranks to one."""
    circulate(tmp_path, run="run 250\nwrite_restart half.restart", launcher=on_ranks(2))
    rest = f"units lj\natom_style sphere\ninclude {LOAD_SPOT}\nread_restart half.restart\n"
    rest += run_text(f"{FIX} recirculate yes", "run 500 upto", after=DUMP)
    run_ok(rest, tmp_path)
    last = read_dump(tmp_path / "fates.dump")[-1]
    there = alone[0][1][10]
    assert last[0] == there[0] == 500
    for name, values in last[1].items():
        assert values.tolist() == there[1][name].tolist(), name
    error = error_of(rest.replace("recirculate yes", "recirculate 15"), tmp_path)
    assert "recirculate was yes in" in error and "is 15 now" in error


@pytest.mark.parametrize("how, before, fix", [
    ("15", "", FIX), ("region top", TOP, FIX), ("yes", "", FIX.replace("peratom yes", "accuracy exact peratom yes")),
    ("yes", "region silo block -5 5 -4 4 0 19\nregion pipe cylinder z 0 0 3 -4 1e-3\nregion all_walls union 2 silo pipe",
     FIX.replace("box -5.0 5.0 -4.0 4.0", "region all_walls")),
])
def test_where_and_how(tmp_path, how, before, fix):
    log, frames = circulate(tmp_path, how, fix=fix, run="run 200\nrun 100", before=before)
    end = frames[-1][1]
    assert len(end["id"]) == len(lattice()) == log["Atoms"][-1]
    assert end["f_drain[5]"].sum() == log["f_drain[3]"][-1] > 100
    assert len(hanging(end, end["z"] > 5)) <= 2


def test_outlets_and_periods(tmp_path):
    """Two slots from side to side, in a silo that repeats; image flags are those of before."""
    box = (-12.0, 12.0, -6.0, 6.0, -4.0, 20.0)
    edge = np.array([1.2, 1.2, 1.25])
    points = np.stack(np.meshgrid(np.arange(-10, 10), np.arange(-5, 5), np.arange(8), indexing="ij"), axis=-1).reshape(-1, 3) * edge
    points = np.concatenate([points, points + edge / 2]) + (0.3, 0, 0.6)
    points = points[abs(points[:, 0]) < 11.5]
    write_data(tmp_path / "packing.data", points, box=box)
    slots = "slot -6 0 0 7.2 12 slot 6 0 0 7.2 12"
    fix = FIX.replace("box -5.0 5.0 -4.0 4.0", "box -12 12 NULL NULL").replace(OPENING, slots).replace("injection 12", "injection 60 30")
    log, frames = circulate(tmp_path, fix=fix, run="run 100", boundary="f p f")
    end = frames[-1][1]
    assert len(end["id"]) == len(points) and end["f_drain[5]"].sum() == log["f_drain[3]"][-1] > 500
    assert log["f_drain[9]"][-1] + log["f_drain[10]"][-1] == log["f_drain[3]"][-1]
    assert log["f_drain[9]"][-1] > 1.5 * log["f_drain[10]"][-1]
    assert abs(end["y"]).max() <= 6 and abs(end["iy"]).max() <= 1
    unwrapped = end["y"] + 12 * end["iy"]
    stayed = end["f_drain[5]"] == 0
    assert unwrapped[stayed] == pytest.approx((frames[0][1]["y"] + end["f_drain[2]"])[stayed], abs=1e-9)


def test_together_with_others_who_take_and_bring(tmp_path):
    """What somebody takes does not come again, and what a fix brings goes round."""
    after = f"{DUMP}\n{TOP}\nfix dep all deposit 40 1 2 4711 region top near 1.0"
    log, frames = circulate(tmp_path, run="run 100\ngroup few id 1:50\ndelete_atoms group few compress no\nrun 800", after=after)
    end = frames[-1][1]
    assert end["id"].tolist() == list(range(51, len(lattice()) + 41)) and log["Atoms"][-1] == len(end["id"])
    assert log["f_drain[3]"][-1] > 100
    assert end["f_drain[5]"][end["id"] > len(lattice())].any()


def test_grains_that_evaporate(tmp_path):
    after = DUMP + "\nregion low block INF INF INF INF 0 5\nfix out all evaporate 10 5 low 49892"
    log, frames = circulate(tmp_path, run="run 200", after=after)
    end = frames[-1][1]
    assert len(end["id"]) == log["Atoms"][-1] == len(lattice()) - 100 and log["f_drain[3]"][-1] > 100


@pytest.mark.parametrize("how, before, said", [
    ("maybe", "", ["'recirculate maybe' is not known", "'recirculate yes'", "a height", "'recirculate region'"]),
    ("", "", ["keyword 'recirculate' ends before its value"]),
    ("region", "", ["ends before its value region-ID"]),
    ("region none", "", ["region 'none' of 'recirculate' does not exist"]),
    ("-2", "", ["'recirculate' puts grains to z = -2", "above the outlets, 0", "up to 20"]),
    ("21", "", ["'recirculate' puts grains to z = 21", "up to 20"]),
    ("region top", "region top block 6 9 -3 3 13 18", ["region 'top' of 'recirculate' is outside the walls"]),
    ("region top", "region top block 4.6 9 -3 3 13 18", ["'recirculate region top' has no place inside the walls"]),
    ("region top", "variable r equal 1+0.01*step\nregion top sphere 0 0 15 v_r", ["moves or changes shape"]),
    ("region top", "region top block -1 1 -1 1 2 4", ["'recirculate region top' has no free place for grain", "1024 were drawn"]),
])
def test_bad_input(tmp_path, how, before, said):
    error = error_of(deck(fix=f"{FIX} recirculate {how}", run="run 50", before=before), tmp_path)
    assert all(words in error for words in said), error
