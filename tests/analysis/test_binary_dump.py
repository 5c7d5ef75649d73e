# SPDX-License-Identifier: GPL-2.0-or-later
"""LAMMPS' binary dumps: read as the text of the same run is, or refused with a cause where they are damaged."""

import shutil
import struct
import subprocess

import numpy as np
import pytest
from spot_analysis.base.errors import DumpError, TruncatedFrame
from spot_analysis.reading.dump import read_frames
from spot_analysis.reading.packing_file import read_packing

from synthetic import binary_frame

LMP = shutil.which("lmp")
DRAWS = np.random.default_rng(1)
COLUMNS = {"vx": DRAWS.normal(size=7), "id": [3, 9, 1, 4, 5, 60, 7], "x": DRAWS.random(7), "y": DRAWS.random(7), "z": DRAWS.random(7),
           "radius": np.full(7, 0.5)}
ORDER = np.argsort(COLUMNS["id"])


def read(path, data, **options):
    path.write_bytes(data)
    return list(read_frames(str(path), **options))


def assert_as_written(frame):
    np.testing.assert_array_equal(frame.ids, np.array(COLUMNS["id"])[ORDER])
    np.testing.assert_array_equal(frame.positions, np.stack([COLUMNS[axis] for axis in "xyz"], axis=1)[ORDER])
    np.testing.assert_array_equal(frame.box, ((-1, 1), (-2, 2), (0, 4)))


@pytest.mark.parametrize("how", [{}, {"ranks": 3}, {"ranks": 9}, {"time": 0.5}, {"order": ">"}, {"kind": "DUMPATOM"}], ids=str)
def test_frames_are_as_written(tmp_path, how):
    found = read(tmp_path / "a.dump.bin", binary_frame(0, COLUMNS, **how) + binary_frame(20, COLUMNS, **how), extra=("v?",))
    assert [frame.timestep for frame in found] == [0, 20]
    for frame in found:
        assert_as_written(frame)
        np.testing.assert_array_equal(frame.extra["vx"], COLUMNS["vx"][ORDER])


def test_a_frame_without_grains(tmp_path):
    (frame,) = read(tmp_path / "a.dump.bin", binary_frame(5, {name: [] for name in COLUMNS}))
    assert frame.timestep == 5 and len(frame.ids) == 0


def test_files_are_read_in_the_order_of_timesteps_beside_text(tmp_path):
    for step in (100, 20):
        (tmp_path / f"drain.{step}.dump.bin").write_bytes(binary_frame(step, COLUMNS))
    (tmp_path / "spots.dump").write_text("ITEM: TIMESTEP\n0\nITEM: NUMBER OF ENTRIES\n0\n")
    assert [frame.timestep for frame in read_frames(str(tmp_path))] == [20, 100]


def test_periodic_boxes_need_unwrapped_positions(tmp_path):
    with pytest.raises(DumpError, match="the box is periodic along y"):
        read(tmp_path / "a.dump.bin", binary_frame(0, COLUMNS, periodic=(0, 1, 0)))
    unwrapped = {**COLUMNS, "yu": COLUMNS["y"]}
    assert_as_written(read(tmp_path / "a.dump.bin", binary_frame(0, unwrapped, periodic=(0, 1, 0)))[0])


def test_a_packing_is_read(tmp_path):
    (tmp_path / "a.bin").write_bytes(binary_frame(0, COLUMNS))
    grains = read_packing(str(tmp_path / "a.bin"))
    assert len(grains.positions) == 7 and (grains.diameters == 1).all()


def test_cut_at_every_byte(tmp_path):
    """All frames that are whole are right; whoever reads fewer than were written is told, but for a cut between frames."""
    first = binary_frame(0, COLUMNS, ranks=2)
    data = first + binary_frame(1, COLUMNS, ranks=2)
    for length in range(1, len(data)):
        (tmp_path / "a.dump.bin").write_bytes(data[:length])
        frames = []
        try:
            frames.extend(read_frames(str(tmp_path / "a.dump.bin")))
            assert length == len(first) and len(frames) == 1
        except DumpError as error:
            assert "a.dump.bin" in str(error) and "\n" not in str(error)
            assert isinstance(error, TruncatedFrame) or length < 18


def test_flipped_bits(tmp_path):
    """The right data, an error with the cause, or other numbers of grains, which no reader can tell."""
    draws, data = np.random.default_rng(3), binary_frame(0, COLUMNS)
    for _ in range(3000):
        damaged = bytearray(data)
        for at in draws.integers(len(data), size=draws.integers(1, 4)):
            damaged[at] ^= 1 << draws.integers(8)
        try:
            for frame in read(tmp_path / "a.dump.bin", bytes(damaged)):
                assert frame.positions.shape == (len(frame.ids), 3)
        except DumpError as error:
            assert "a.dump.bin" in str(error) and "\n" not in str(error)


WIDTH = 8 + 10 + 8 + 16 + 4 + 24 + 48  # bytes before the number of columns
BAD = {
    "another format": (18 + 4, struct.pack("<i", 1), "format 1"),
    "tilted": (18 + 8 + 16, struct.pack("<i", 2), "tilted"),
    "no timestep": (18 + 8, struct.pack("<q", -5), "timestep -5"),
    "columns without names": (WIDTH, struct.pack("<i", 7), "7 columns called vx id x y z radius"),
    "endless names": (WIDTH + 4 + 4 + 1, struct.pack("<i", 2**30), "letters long"),
    "too large a block": (-6 * 7 * 8 - 4, struct.pack("<i", 43), "a block of 43 numbers, where 42 are left"),
    "too small a block": (-6 * 7 * 8 - 4, struct.pack("<i", 41), "1 numbers are missing"),
    "an id twice": (-6 * 7 * 8 + 8, struct.pack("<d", 9), "grain id 9 stands twice"),
    "not finite": (-6 * 7 * 8 + 16, struct.pack("<d", np.nan), "position of grain 3 is not finite"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_files_are_errors_with_a_cause(tmp_path, case):
    at, words, said = BAD[case]
    data = bytearray(binary_frame(0, COLUMNS))
    at = at % len(data)
    data[at:at + len(words)] = words
    with pytest.raises(DumpError, match=said):
        read(tmp_path / "a.dump.bin", bytes(data))


@pytest.mark.skipif(LMP is None, reason="needs lmp on the PATH (Debian: apt install lammps)")
@pytest.mark.parametrize("boundary, box, speed", [("f f f", "", 0.2), ("f p f", "", 0.9), ("f f f", "change_box all triclinic\n", 0.2)])
def test_lammps_writes_the_same_as_text(tmp_path, boundary, box, speed):
    """Grains stay inside, but those that go around the box."""
    (tmp_path / "in.both").write_text(
        f"units lj\natom_style sphere\nboundary {boundary}\nregion box block -3 3 -2 2 0 9\ncreate_box 1 box\n"
        f"region middle block -2 2 -1 1 1 8\ncreate_atoms 1 random 50 7 middle\nset group all diameter 0.3\n{box}"
        f"fix move all move linear 0.1 {speed} 0\ntimestep 1\n"
        "dump text all custom 2 a.dump id x yu z radius\ndump binary all custom 2 b.dump.bin id x yu z radius\n"
        "dump_modify text format float %.17g\ndump_modify binary time yes\nrun 4\n")
    done = subprocess.run([LMP, "-in", "in.both", "-log", "none"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    text, binary = (list(read_frames(str(tmp_path / name), extra=("radius",))) for name in ("a.dump", "b.dump.bin"))
    assert [frame.timestep for frame in text] == [frame.timestep for frame in binary] == [0, 2, 4]
    for one, other in zip(text, binary):
        np.testing.assert_array_equal(one.ids, other.ids)
        np.testing.assert_array_equal(one.positions, other.positions)
        np.testing.assert_array_equal(one.box, other.box)
        np.testing.assert_array_equal(one.extra["radius"], other.extra["radius"])
