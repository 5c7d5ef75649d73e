# SPDX-License-Identifier: GPL-2.0-or-later
"""Damaged dumps: the reader gives the right data or a DumpError with the cause; never another exception, never data that
nobody wrote. Seeds are fixed; SPOT_DUMPS=n tries n damaged files of each kind."""

import gzip
import os

import numpy as np
import pytest
import zstandard
from spot_analysis.base.errors import DumpError
from spot_analysis.reading.dump import read_frames

from synthetic import frame_text

DUMPS = int(os.environ.get("SPOT_DUMPS", 300))
STEPS = (0, 50, 100)
COLUMNS = "id type x y z vx"


def frames():
    """{timestep: (ids, positions, velocities)} of what is written, sorted by id."""
    rng = np.random.default_rng(1)
    written = {}
    for step, count in zip(STEPS, (23, 20, 1)):
        ids = np.sort(rng.choice(np.arange(1, 60), count, replace=False))
        written[step] = (ids, np.round(rng.uniform(-2, 4, (count, 3)), 6), np.round(rng.normal(size=count), 6))
    return written


WRITTEN = frames()
TEXT = "".join(frame_text(step, ids, positions, COLUMNS, extra=[("vx", v)]) for step, (ids, positions, v) in WRITTEN.items())


def read(path, data):
    """Frames and warnings, or the text of the DumpError."""
    path.write_bytes(data)
    warnings = []
    try:
        return list(read_frames(str(path), extra=("vx",), warn=warnings.append)), warnings, None
    except DumpError as error:
        assert path.name in str(error) and "\n" not in str(error)
        return [], warnings, str(error)


def assert_as_written(frame):
    ids, positions, velocities = WRITTEN[frame.timestep]
    np.testing.assert_array_equal(frame.ids, ids)
    np.testing.assert_array_equal(frame.positions, positions)
    np.testing.assert_array_equal(frame.extra["vx"], velocities)


def assert_cut_is_noticed(found, whole):
    """Complete frames are right, and whoever reads fewer of them than were written is told."""
    frames_read, warnings, error = found
    for frame in frames_read:
        assert_as_written(frame)
    assert [frame.timestep for frame in frames_read] == list(STEPS[:len(frames_read)])
    assert error or warnings or len(frames_read) == whole


def frames_before(text, length):
    """Frames in the first bytes of a text, if these end exactly behind one; else more than there are."""
    ends = [index for index in range(1, len(text) + 1) if text[index:].startswith("ITEM: TIMESTEP") or index == len(text)]
    return ends.index(length) + 1 if length in ends else len(STEPS) + 1


def test_undamaged(tmp_path):
    found, warnings, error = read(tmp_path / "a.dump", TEXT.encode())
    assert error is None and not warnings and len(found) == len(STEPS)
    for frame in found:
        assert_as_written(frame)


def test_cut_at_every_byte(tmp_path):
    for length in range(len(TEXT)):
        found = read(tmp_path / "a.dump", TEXT[:length].encode())
        assert_cut_is_noticed(found, frames_before(TEXT, length))


COMPRESSED = {"gz": gzip.compress(TEXT.encode(), mtime=0), "zst": zstandard.compress(TEXT.encode())}


@pytest.mark.parametrize("kind", COMPRESSED)
def test_compressed_cut_at_every_byte(tmp_path, kind):
    for length in range(len(COMPRESSED[kind])):
        found = read(tmp_path / f"a.dump.{kind}", COMPRESSED[kind][:length])
        assert_cut_is_noticed(found, len(STEPS))
        assert found[2], length


def same_as_written(frame):
    try:
        assert_as_written(frame)
    except (AssertionError, KeyError):
        return False
    return True


def flipped(data, rng):
    damaged = bytearray(data)
    for at in rng.integers(len(data), size=rng.integers(1, 4)):
        damaged[at] ^= 1 << rng.integers(8)
    return bytes(damaged)


@pytest.mark.parametrize("kind", COMPRESSED)
def test_compressed_with_flipped_bits(tmp_path, kind):
    """The checksum of gzip stands at the end, behind the frames; zstd, as dumps are written, has none."""
    rng = np.random.default_rng(2)
    for _ in range(DUMPS):
        frames_read, warnings, error = read(tmp_path / f"a.dump.{kind}", flipped(COMPRESSED[kind], rng))
        if kind == "zst":
            continue
        right = len(frames_read) == len(STEPS) and all(map(same_as_written, frames_read))
        assert right or error or warnings


NUMBERS = ("nan", "inf", "-inf", "1e999", "0x10", "1_0", "", "-", "abc", "1.5.2", "\xff", "1,5", "1e")


def corrupt_table(rng):
    """The text with one word of one row of numbers made none, lost or doubled; the row's number."""
    lines = TEXT.splitlines(True)
    rows = [k for k, line in enumerate(lines) if len(line.split()) == len(COLUMNS.split()) and not line.startswith("ITEM")]
    row = rows[rng.integers(len(rows))]
    words = lines[row].split()
    column = [0, 2, 3, 4, 5][rng.integers(5)]
    how = rng.integers(3)
    if how == 0 and column == 5:  # velocities that are not finite are left to whoever asks for them
        words[column] = "abc"
    elif how == 0:
        words[column] = NUMBERS[rng.integers(len(NUMBERS))]
    elif how == 1:
        del words[column]
    else:
        words.insert(column, words[column])
    lines[row] = " ".join(words) + " \n"
    return "".join(lines), row


def test_corrupted_columns_are_an_error_that_names_the_line(tmp_path):
    rng = np.random.default_rng(3)
    for _ in range(DUMPS):
        text, row = corrupt_table(rng)
        _, _, error = read(tmp_path / "a.dump", text.encode("latin-1"))
        assert error, text.splitlines()[row]
        assert "line" in error


@pytest.mark.parametrize("item", ["TIMESTEP", "NUMBER OF ATOMS", "BOX BOUNDS ff ff ff", "ATOMS " + COLUMNS + " "])
def test_missing_items(tmp_path, item):
    for copies in ("", 2 * f"ITEM: {item}\n"):
        _, _, error = read(tmp_path / "a.dump", TEXT.replace(f"ITEM: {item}\n", copies, 1).encode())
        assert error


def test_lines_lost_doubled_or_swapped(tmp_path):
    """A row that stands elsewhere in its frame is no damage; everything else is noticed, or comes in another order of steps."""
    rng = np.random.default_rng(4)
    for _ in range(DUMPS):
        lines = TEXT.splitlines(True)
        one, other = rng.integers(len(lines), size=2)
        how = rng.integers(3)
        if how == 0:
            del lines[one]
        elif how == 1:
            lines.insert(one, lines[one])
        else:
            lines[one], lines[other] = lines[other], lines[one]
        found, warnings, error = read(tmp_path / "a.dump", "".join(lines).encode())
        if error or warnings:
            continue
        moved_between_frames = how == 2 and len(found) == len(STEPS)
        assert moved_between_frames or all(map(same_as_written, found)), (how, one, other)


def test_random_bytes_give_no_other_exception(tmp_path):
    rng = np.random.default_rng(5)
    for _ in range(DUMPS):
        read(tmp_path / "a.dump", flipped(TEXT.encode(), rng))
        read(tmp_path / "b.dump", rng.bytes(rng.integers(1, 200)))
