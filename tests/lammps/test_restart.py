# SPDX-License-Identifier: GPL-2.0-or-later
"""A run that goes on from a restart file gives the bits of one that was never interrupted, on any number of ranks."""

import os
import random
import re
import signal
import struct
import subprocess
import time

import pytest

from lammps_runs import FIX, FRONT_END, LOAD_SPOT, deck, drain, error_of, lattice, needs_mpirun, on_ranks, run, run_ok, run_text, thermo, write_data

FIX = FIX + " volume 77"
EXACT = FIX + " accuracy exact"
EACH = "grains.*.dump"  # every snapshot in a file of its own


def rest_of(restart, steps, fix=FIX, **parts):
    """The deck that goes on until so many steps are done."""
    return f"""
units lj
atom_style sphere
include {LOAD_SPOT}
read_restart {restart}
""" + run_text(fix, f"run {steps} upto", dumps=EACH, **parts)


def snapshots(folder):
    return {path.name: path.read_bytes() for path in folder.glob("grains.*.dump")}


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """Thermo output and snapshots of the run that was never interrupted."""
    folder = tmp_path_factory.mktemp("whole")
    said = run_ok(deck(fix=FIX, dumps=EACH), folder)
    return thermo(said), snapshots(folder)


def go_on(folder, restart, whole, launcher=(), **parts):
    values, dumps = whole
    said = thermo(run_ok(rest_of(restart, 30, **parts), folder, launcher=launcher))
    for name, dump in snapshots(folder).items():
        assert dump == dumps[name], name
    steps = [step for step in said["Step"] if step in values["Step"]]
    assert len(steps) > 2
    for column in values.keys() - {"f_drain[4]"}:  # a sum in another order
        mine, theirs = (dict(zip(table["Step"], table[column])) for table in (said, values))
        assert [mine[step] for step in steps] == [theirs[step] for step in steps], column


@needs_mpirun
@pytest.mark.parametrize("before, after", [(1, 1), (1, 3), (2, 1), (3, 2)])
def test_goes_on_with_the_same_bits(whole, tmp_path, before, after):
    run_ok(deck(fix=FIX, run="run 13\nwrite_restart half.restart", dumps=EACH), tmp_path, launcher=on_ranks(before))
    go_on(tmp_path, "half.restart", whole, launcher=on_ranks(after))


def test_after_clear(whole, tmp_path):
    run_ok(deck(fix=FIX, run="run 20\nwrite_restart half.restart", dumps=EACH) + "\nclear\n" + rest_of("half.restart", 30), tmp_path)
    assert snapshots(tmp_path) == whole[1]


def test_order_of_time(tmp_path):
    (tmp_path / "one").mkdir()
    one = deck(fix=EXACT, run="run 20", dumps=EACH)
    run_ok(one, tmp_path / "one")
    run_ok(deck(fix=EXACT, run="run 7\nwrite_restart half.restart", dumps=EACH), tmp_path)
    run_ok(rest_of("half.restart", 20, fix=EXACT), tmp_path)
    assert snapshots(tmp_path) == snapshots(tmp_path / "one")


def test_another_timestep_with_the_same_window(tmp_path):
    windowed = FIX + " window 0.005"
    (tmp_path / "one").mkdir()
    run_ok(deck(fix=windowed, dumps=EACH), tmp_path / "one")
    run_ok(deck(fix=windowed, run="run 10\nwrite_restart half.restart", dumps=EACH), tmp_path)
    run_ok(rest_of("half.restart", 20, fix=windowed, timestep=0.2), tmp_path)
    columns = slice(0, 6)  # all but the velocities
    rows = [[line.split()[columns] for line in (folder / name).read_text().splitlines()[9:]]
            for folder, name in ((tmp_path / "one", "grains.30.dump"), (tmp_path, "grains.20.dump"))]
    assert rows[0] == rows[1]


@pytest.fixture(scope="module")
def half(tmp_path_factory):
    folder = tmp_path_factory.mktemp("half")
    run_ok(deck(fix=FIX, run="run 5\nwrite_restart half.restart"), folder)
    return folder / "half.restart"


@pytest.mark.parametrize("change, said", [("seed 2", "seed was 1 in the run"), ("influence 0.02", "influence was 0.01"),
                                          ("alpha 1.1", "alpha was 0.8"), ("window 0.0025", "window was 0.05"),
                                          ("accuracy exact", "dz was 1.2"), ("volume 77 critical 0.58 1", "critical was 0 0 in"),
                                          ("outlet -0.5", "outlet was 0 in the run")])
def test_changed_parameters_are_refused(half, tmp_path, change, said):
    error = error_of(rest_of(half, 10, fix=f"{FIX} {change}"), tmp_path)
    assert said in error and "give the fix another ID" in error


def test_threads_may_change(half, tmp_path):
    run_ok(rest_of(half, 10, fix=FIX + " threads 2"), tmp_path)


def test_another_id_starts_anew(half, tmp_path):
    said = run_ok(rest_of(half, 10, fix=FIX.replace("fix drain", "fix other") + " seed 2").replace("f_drain", "f_other"), tmp_path)
    assert thermo(said)["f_other[2]"][0] == 0


def test_half_written_files_are_refused(half, tmp_path):
    whole = half.read_bytes()
    for part in (0.05, 0.3, 0.6, 0.9, 0.99):
        (tmp_path / "cut.restart").write_bytes(whole[:int(part * len(whole))])
        done = run(rest_of("cut.restart", 10), tmp_path)
        assert done.returncode > 0 and "ERROR" in done.stdout + done.stderr, part


# From where "spot run" begins: version, lengths, checksum; the head; somewhere among the grains. saved_run_test.cpp has all others.
@pytest.mark.parametrize("place", [8, 16, 24, 39, 48, 20000])
def test_damaged_state_is_refused(half, tmp_path, place):
    data = bytearray(half.read_bytes())
    data[data.index(b"spot run") + place] ^= 0x10
    (tmp_path / "bad.restart").write_bytes(data)
    assert "damaged" in error_of(rest_of("bad.restart", 10), tmp_path)


@pytest.mark.parametrize("bit", [0, 3, 4, 8, 12, 14, 15, 20, 30, 31])
def test_damaged_length_is_no_crash(half, tmp_path, bit):
    """Of the state, as LAMMPS reads it: an error, or, where nothing that counts was lost, the same bits. Never what a crash ends with."""
    data = bytearray(half.read_bytes())
    at = data.index(b"spot run") - 4
    length = struct.unpack_from("<i", data, at)[0]
    assert 0 < length < len(data) - at
    data[at + bit // 8] ^= 1 << bit % 8
    (tmp_path / "bad.restart").write_bytes(data)
    done = run(rest_of("bad.restart", 10), tmp_path)
    if done.returncode == 0:
        (tmp_path / "sound").mkdir()
        run_ok(rest_of(half, 10), tmp_path / "sound")
        assert snapshots(tmp_path) == snapshots(tmp_path / "sound")
    else:
        assert done.returncode > 0 and "ERROR" in done.stdout + done.stderr


@pytest.mark.parametrize("version", [4, 5, 14, 16])
def test_another_version_is_refused_with_advice(half, tmp_path, version):
    """Version 4 has a length where those since have the version again, with all bits flipped."""
    data = bytearray(half.read_bytes())
    struct.pack_into("<ii", data, data.index(b"spot run") + 8, version, 45000 if version == 4 else ~version)
    (tmp_path / "other.restart").write_bytes(data)
    error = error_of(rest_of("other.restart", 10), tmp_path)
    assert f"of format {version} of fix spot" in error and "give the fix another ID" in error
    said = run_ok(rest_of("other.restart", 10).replace("fix drain", "fix other").replace("f_drain", "f_other"), tmp_path)
    assert thermo(said)["f_other[2]"][0] == 0


@needs_mpirun
@pytest.mark.parametrize("before, after", [(1, 1), (3, 2)])
def test_emptied_silo_goes_on(tmp_path, before, after):
    """Spots are born and climb as if it had never stopped; without the restart there is no grain to say how large it was."""
    write_data(tmp_path / "packing.data", lattice(lambda x, y, z: x * x + y * y < 1.5 and z < 3))
    whole = thermo(run_ok(deck(fix=FIX, run="run 40\nwrite_restart empty.restart\nrun 20"), tmp_path, launcher=on_ranks(before)))
    at_restart = list(whole["Step"]).index(40)
    assert whole["Atoms"][0] == whole["f_drain[3]"][-1] == 14 and whole["Atoms"][at_restart] == 0
    rest = thermo(run_ok(rest_of("empty.restart", 60), tmp_path, launcher=on_ranks(after)))
    for column in whole:
        assert rest[column][-1] == pytest.approx(whole[column][-1], rel=1e-14 if column == "f_drain[4]" else 0), column
    assert rest["f_drain[1]"][-1] > 0 and rest["f_drain[2]"][-1] > rest["f_drain[2]"][0]
    assert "no grains" in error_of(rest_of("empty.restart", 60).replace("fix drain", "fix other").replace("f_drain", "f_other"), tmp_path)


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
def test_full_disk(tmp_path):
    """What is there already stays; LAMMPS or the fix says what is wrong."""
    (tmp_path / "a.restart").symlink_to("/dev/full")
    done = run(deck(fix=FIX, run="run 3\nwrite_restart good.restart\nrun 2\nwrite_restart a.restart"), tmp_path)
    assert done.returncode != 0
    assert re.search("disk full|No space|rror", done.stdout + done.stderr)
    run_ok(rest_of("good.restart", 10), tmp_path)


def test_before_the_first_run(tmp_path):
    assert "before the first run" in error_of(deck(fix=FIX, run="write_restart a.restart"), tmp_path)


def test_killed_at_random_moments(tmp_path):
    """SIGKILL while it runs and writes restart files in turn; whatever whole file is newest leads to the same end."""
    # Small windows, so that there is time to kill it in.
    fix = FIX + " window 0.002"
    (tmp_path / "one").mkdir()
    begin = time.monotonic()
    run_ok(deck(fix=fix, run="run 60", dumps=EACH), tmp_path / "one")
    duration = time.monotonic() - begin
    end = snapshots(tmp_path / "one")["grains.60.dump"]
    draws = random.Random(1)
    for attempt in range(int(os.environ.get("SPOT_KILLS", "20"))):
        folder = tmp_path / f"killed{attempt}"
        folder.mkdir()
        (folder / "packing.data").write_bytes((tmp_path / "one" / "packing.data").read_bytes())
        (folder / "in.deck").write_text(deck(fix=fix, after="restart 3 a.restart b.restart", run="run 60", dumps=EACH))
        process = subprocess.Popen([FRONT_END, "-in", "in.deck", "-log", "none"], cwd=folder, stdout=subprocess.DEVNULL)
        time.sleep(draws.uniform(0.1, 0.9) * duration)
        process.send_signal(signal.SIGKILL)
        process.wait()
        assert resumed(folder, fix) == end, attempt


def resumed(folder, fix):
    """The last snapshot, from the newest restart file that is whole, or from the start if there is none."""
    files = sorted(folder.glob("[ab].restart"), key=lambda path: path.stat().st_mtime, reverse=True)
    for path in files:
        text = rest_of(path.name, 60, fix=fix)
        if run(text, folder).returncode == 0:
            return snapshots(folder)["grains.60.dump"]
    run_ok(deck(fix=fix, run="run 60", dumps=EACH), folder)
    return snapshots(folder)["grains.60.dump"]
