# SPDX-License-Identifier: GPL-2.0-or-later
"""Reader of LAMMPS and LIGGGHTS dumps."""

import gzip

import numpy as np
import pytest
import zstandard
from spot_analysis.base.errors import DumpError, TruncatedFrame
from spot_analysis.reading.dump import find_dumps, read_file, read_frames

from synthetic import frame_text, write_text

IDS = np.array([3, 1, 2])
POSITIONS = np.array([[0.3, -0.3, 3.0], [0.1, -0.1, 1.0], [0.2, -0.2, 2.0]])
SORTED = POSITIONS[[1, 2, 0]]


def refuse(text):
    raise AssertionError(f"unexpected warning: {text}")


@pytest.fixture
def dump(tmp_path):
    def write(text, name="a.dump"):
        return write_text(tmp_path / name, text)
    return write


def only_frame(path, **options):
    frames = list(read_frames(path, warn=refuse, **options))
    assert len(frames) == 1
    return frames[0]


@pytest.mark.parametrize("name", ["a.dump", "a.dump.gz", "a.dump.zst", "a.lammpstrj"])
def test_sorted_by_id_plain_and_gzip(dump, name):
    frame = only_frame(dump(frame_text(7, IDS, POSITIONS), name))
    assert frame.timestep == 7
    np.testing.assert_array_equal(frame.ids, [1, 2, 3])
    np.testing.assert_array_equal(frame.positions, SORTED)
    np.testing.assert_array_equal(frame.box, [[-1, 1], [-2, 2], [0, 4]])


@pytest.mark.parametrize("columns", ["id x y z", "z type y id x", "type id x y z"])
def test_any_column_order(dump, columns):
    np.testing.assert_array_equal(only_frame(dump(frame_text(0, IDS, POSITIONS, columns))).positions, SORTED)


def test_extra_columns_where_present(dump):
    text = frame_text(0, IDS, POSITIONS, "id radius x y z", extra=[("radius", [0.3, 0.1, 0.2])])
    frame = only_frame(dump(text), extra=("radius", "vx"))
    assert list(frame.extra) == ["radius"]
    np.testing.assert_array_equal(frame.extra["radius"], [0.1, 0.2, 0.3])


def test_text_columns_are_skipped(dump):
    text = frame_text(0, IDS, POSITIONS, "id type x y z").replace(" 1 0.", " Si 0.")
    np.testing.assert_array_equal(only_frame(dump(text)).positions, SORTED)


def test_unwrapped_and_scaled_positions(dump):
    unwrapped = frame_text(0, IDS, POSITIONS).replace("id x y z", "id xu yu zu")
    np.testing.assert_array_equal(only_frame(dump(unwrapped)).positions, SORTED)
    scaled = frame_text(0, IDS, (POSITIONS - [-1, -2, 0]) / [2, 4, 4]).replace("id x y z", "id xs ys zs")
    np.testing.assert_allclose(only_frame(dump(scaled)).positions, SORTED, atol=1e-11)


IMAGES = np.array([[0, 0, 3], [-1, 0, 0], [2, 5, 0]])
SIZES = np.array([2, 4, 4])  # of the box of frame_text
CROSSED = (POSITIONS + IMAGES * SIZES)[[1, 2, 0]]


def periodic(columns, flags="pp pp pp", **extra):
    """POSITIONS in a periodic box, that were wrapped by IMAGES; xu and so on hold where grains went."""
    low = np.array([-1, -2, 0])
    named = {"{}u": POSITIONS + IMAGES * SIZES, "{}s": (POSITIONS - low) / SIZES, "i{}": IMAGES,
             "{}su": (POSITIONS + IMAGES * SIZES - low) / SIZES}
    values = [(name.format(axis), part[:, k]) for name, part in named.items() for k, axis in enumerate("xyz")]
    text = frame_text(0, IDS, POSITIONS, columns, extra=[*values, *extra.items()])
    return text.replace("BOUNDS ff ff ff", f"BOUNDS {flags}")


@pytest.mark.parametrize("columns", [
    "id xu yu zu", "id x y z xu yu zu", "id x y z ix iy iz", "id iz iy ix z y x", "id xs ys zs ix iy iz", "id xsu ysu zsu",
    "id xs ys zs xsu ysu zsu", "id x ix yu zsu"])
def test_periodic_box(dump, columns):
    np.testing.assert_allclose(only_frame(dump(periodic(columns))).positions, CROSSED, rtol=0, atol=1e-10)


def test_box_that_is_periodic_along_one_axis(dump):
    frame = only_frame(dump(periodic("id x y z iy", "fs pp mm")))
    np.testing.assert_allclose(frame.positions, np.column_stack([SORTED[:, 0], CROSSED[:, 1], SORTED[:, 2]]), atol=1e-10)


@pytest.mark.parametrize("columns, flags, message", [
    ("id x y z", "pp ff ff", "periodic along x, where column 'x' alone.*column 'xu' or the image flags 'ix' are missing"),
    ("id x y z ix", "pp pp ff", "periodic along y"),
    ("id xs ys zs", "ff ff pp", "periodic along z, where column 'zs' alone"),
])
def test_wrapped_positions_are_refused(dump, columns, flags, message):
    with pytest.raises(DumpError, match=f"a.dump, line 9: .*{message}"):
        list(read_frames(dump(periodic(columns, flags))))


def test_image_flags_are_whole_numbers(dump):
    with pytest.raises(DumpError, match="a.dump.*column 'iy' holds values that are no whole numbers"):
        list(read_frames(dump(periodic("id x y z ix iy iz", iy=[0, 0.5, 0]))))


def triclinic(*tilts, flags="ff ff ff"):
    text = frame_text(0, IDS, POSITIONS).replace("BOUNDS ff ff ff", f"BOUNDS xy xz yz {flags}")
    for bounds, tilt in zip(("-1 1", "-2 2", "0 4"), tilts):
        text = text.replace(f"\n{bounds}\n", f"\n{bounds} {tilt}\n")
    return text


def test_triclinic_box_without_tilt(dump):
    frame = only_frame(dump(triclinic("0.0", "-0", "0e0")))
    np.testing.assert_array_equal(frame.positions, SORTED)
    np.testing.assert_array_equal(frame.box, [[-1, 1], [-2, 2], [0, 4]])
    with pytest.raises(DumpError, match="periodic along x"):
        list(read_frames(dump(triclinic(0, 0, 0, flags="pp ff ff"))))


@pytest.mark.parametrize("tilts", [(0.1, 0, 0), (0, -2, 0), (0, 0, 1e-9), ("nan", 0, 0)])
def test_tilted_box_is_refused(dump, tilts):
    with pytest.raises(DumpError, match="a.dump, line 8: .*the box is tilted .xy = "):
        list(read_frames(dump(triclinic(*tilts))))


def test_plain_positions_win_over_scaled(dump):
    text = frame_text(0, IDS, POSITIONS, "id xs ys zs x y z", extra=[(n, np.zeros(3)) for n in ("xs", "ys", "zs")])
    np.testing.assert_array_equal(only_frame(dump(text)).positions, SORTED)


def test_time_and_units_items(dump):
    before = "ITEM: UNITS\nsi\nITEM: TIME\n0.035\n"
    assert only_frame(dump(frame_text(20, IDS, POSITIONS, before=before))).timestep == 20


def test_many_frames_with_changing_counts(dump):
    path = dump(frame_text(0, IDS, POSITIONS) + frame_text(5, IDS[:2], POSITIONS[:2])
                + frame_text(9, [], np.empty((0, 3))))
    frames = list(read_frames(path, warn=refuse))
    assert [(frame.timestep, len(frame.ids)) for frame in frames] == [(0, 3), (5, 2), (9, 0)]


def test_folder_is_read_in_order_of_timesteps(dump, tmp_path):
    for step in (1000, 20, 300):
        dump(frame_text(step, IDS, POSITIONS), f"run.{step}.dump.gz")
    dump("log of the run", "log.lammps")
    dump("ITEM: TIMESTEP\n0\nITEM: NUMBER OF ENTRIES\n0\n"
         "ITEM: BOX BOUNDS ff ff ff\n0 1\n0 1\n0 1\nITEM: ENTRIES index\n", "spots.dump")
    for source in (str(tmp_path), str(tmp_path / "run.*.gz")):
        assert [frame.timestep for frame in read_frames(source, warn=refuse)] == [20, 300, 1000]


def test_repeated_timestep_is_left_out_with_a_warning(dump, tmp_path):
    dump(frame_text(0, IDS, POSITIONS) + frame_text(5, IDS, POSITIONS), "a.dump")
    dump(frame_text(5, IDS, POSITIONS) + frame_text(9, IDS, POSITIONS), "b.dump")
    warnings = []
    assert [frame.timestep for frame in read_frames(str(tmp_path), warn=warnings.append)] == [0, 5, 9]
    assert len(warnings) == 1 and "b.dump: timestep 5" in warnings[0]


FRAMES = frame_text(0, IDS, POSITIONS) + frame_text(5, IDS, POSITIONS)
SECOND = FRAMES.index("ITEM: TIMESTEP", 1)


@pytest.mark.parametrize("length", [*range(SECOND + 1, len(FRAMES), 7), len(FRAMES) - 1])
def test_truncated_last_frame_is_an_error_that_names_the_file(dump, length):
    with pytest.raises(TruncatedFrame, match="a.dump, line .*the file ends inside .*the disk was full"):
        list(read_frames(dump(FRAMES[:length]), warn=refuse))


def test_truncated_frame_says_how_much_of_it_there_is(dump):
    with pytest.raises(TruncatedFrame, match="a.dump, line"):
        list(read_file(dump(FRAMES[:-5])))
    with pytest.raises(TruncatedFrame, match="2 of 3 lines"):
        list(read_frames(dump("".join(FRAMES[:SECOND].splitlines(True)[:-1]))))


@pytest.mark.parametrize("cut", [0, 1])
def test_truncated_file_in_a_folder_is_an_error(dump, tmp_path, cut):
    for number, text in enumerate((FRAMES[:SECOND], FRAMES[SECOND:])):
        dump(text[:-4] if number == cut else text, f"run.{5 * number}.dump")
    with pytest.raises(TruncatedFrame, match=f"run.{5 * cut}.dump"):
        list(read_frames(str(tmp_path)))


def test_empty_file_in_a_folder_is_an_error(dump, tmp_path):
    dump(FRAMES[:SECOND], "run.0.dump")
    dump("", "run.5.dump")
    with pytest.raises(DumpError, match="run.5.dump: the file is empty"):
        list(read_frames(str(tmp_path)))


COMPRESSED = {"a.dump.gz": gzip.compress, "a.dump.zst": zstandard.compress}


@pytest.mark.parametrize("name", COMPRESSED)
def test_compressed_files_put_together(tmp_path, name):
    path = tmp_path / name
    path.write_bytes(b"".join(COMPRESSED[name](text.encode()) for text in (FRAMES[:SECOND], FRAMES[SECOND:])))
    assert [frame.timestep for frame in read_frames(str(path), warn=refuse)] == [0, 5]


@pytest.mark.parametrize("name", COMPRESSED)
def test_compressed_file_cut_between_frames(tmp_path, name):
    """Of what was compressed, all that can be read is whole frames."""
    path = tmp_path / name
    if name.endswith("gz"):
        with gzip.open(path, "wt") as file:
            file.write(FRAMES)
        path.write_bytes(path.read_bytes()[:-8])  # without checksum and length
    else:
        compressor = zstandard.ZstdCompressor().compressobj()
        path.write_bytes(compressor.compress(FRAMES.encode()) + compressor.flush(zstandard.COMPRESSOBJ_FLUSH_BLOCK))
    with pytest.raises(TruncatedFrame, match=f"{name}: the compressed file ends after line 24"):
        list(read_frames(str(path), warn=refuse))


@pytest.mark.parametrize("name", COMPRESSED)
def test_truncated_compressed_file(tmp_path, name):
    compress = COMPRESSED[name]
    rng = np.random.default_rng(1)
    text = "".join(frame_text(step, np.arange(5000), rng.random((5000, 3))) for step in (0, 1, 2))
    path = tmp_path / name
    data = compress(text.encode())
    path.write_bytes(data[:len(data) * 5 // 6])
    steps = []
    with pytest.raises(TruncatedFrame, match=f"{name}: the compressed file ends"):
        for frame in read_frames(str(path), warn=refuse):
            steps.append(frame.timestep)
    assert steps == [0, 1]


@pytest.mark.parametrize("name, magic", [("a.dump.gz", b"\x1f\x8b"), ("a.dump.zst", b"\x28\xb5\x2f\xfd")])
def test_damaged_compressed_file(tmp_path, name, magic):
    path = tmp_path / name
    path.write_bytes(magic + b"nonsense" * 20)
    with pytest.raises(DumpError, match=name):
        list(read_frames(str(path)))


BAD = {
    "empty": ("", "the file is empty"),
    "no dump": ("hello\n", "line 1.*expected a line 'ITEM"),
    "NaN": (FRAMES.replace("0.2 -0.2", "nan -0.2", 1), "position of grain 2 is not finite"),
    "no id": (FRAMES.replace("ATOMS id", "ATOMS mol"), "line 9: column 'id' is missing"),
    "no y": (FRAMES.replace("x y z", "x vy z"), "line 9: column 'y' is missing"),
    "no position": (FRAMES.replace("x y z", "vx vy vz"), "column 'x' is missing"),
    "no number": (FRAMES.replace("-0.2", "abc", 1), "line 12: column 'y' is no number: 'abc'"),
    "short row": (FRAMES.replace("2 0.2 -0.2 2", "2 0.2 -0.2", 1), "line 12: expected 4 columns"),
    "long row": (FRAMES.replace("2 0.2 -0.2 2", "2 0.2 -0.2 2 9", 1), "line 12: expected 4 columns"),
    "missing row": (FRAMES.replace("2 0.2 -0.2 2 \n", "", 1), "line 12: expected 4 columns"),
    "additional row": (FRAMES.replace("2 0.2 -0.2 2 \n", "2 0.2 -0.2 2 \n4 0 0 0 \n", 1),
                       "line 13: expected a line 'ITEM"),
    "repeated id": (FRAMES.replace("2 0.2", "1 0.2", 1), "grain id 1 stands twice"),
    "fractional id": (FRAMES.replace("2 0.2", "2.5 0.2", 1), "'id' holds values that are no whole numbers"),
    "no count": (FRAMES.replace("ITEM: NUMBER OF ATOMS\n3\n", "", 1), "without an 'ITEM: NUMBER OF ATOMS'"),
    "bad count": (FRAMES.replace("ATOMS\n3\n", "ATOMS\n-3\n", 1), "line 4: .* wants a whole number, found '-3'"),
    "local dump": ("ITEM: TIMESTEP\n0\nITEM: NUMBER OF ENTRIES\n0\n", "unknown 'ITEM: NUMBER OF ENTRIES'"),
    "tilt that the header does not name": (FRAMES.replace("-1 1", "-1 1 0", 1), "triclinic box has a third"),
    "no tilt that the header names": (FRAMES.replace("BOUNDS ff", "BOUNDS xy xz yz ff", 1), "line 8.*two numbers an axis, and a tilt"),
    "general triclinic": (FRAMES.replace("BOUNDS ff ff ff", "BOUNDS abc origin", 1), "line 5.*'abc origin' .general triclinic"),
    "bounds that are no numbers": (FRAMES.replace("-1 1", "-1 b", 1), "BOX BOUNDS"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_files_are_errors_with_a_cause(dump, case):
    text, message = BAD[case]
    with pytest.raises(DumpError, match=message) as caught:
        list(read_frames(dump(text), warn=refuse))
    assert "a.dump" in str(caught.value) and "\n" not in str(caught.value)
    assert not isinstance(caught.value, TruncatedFrame)


def test_nothing_to_read(tmp_path):
    for source in (tmp_path, tmp_path / "absent", tmp_path / "*.dump"):
        with pytest.raises(DumpError, match="no "):
            find_dumps(str(source))


def test_zstd_file_cut_before_its_first_line(tmp_path):
    path = tmp_path / "a.dump.zst"
    path.write_bytes(zstandard.compress(FRAMES.encode())[:30])
    with pytest.raises(TruncatedFrame, match="a.dump.zst: the compressed file ends after line 0"):
        list(read_frames(str(path)))
