# SPDX-License-Identifier: GPL-2.0-or-later
"""Opens text files, plain, gzip or zstd, told by their first bytes."""

import contextlib
import gzip
import io
import zlib

import zstandard

from ..base.errors import DumpError

DAMAGED = (zlib.error, gzip.BadGzipFile, zstandard.ZstdError)


class _ZstdReader(io.RawIOBase):
    """Decompressed bytes of a zstd file of one or more zstd frames; EOFError where the last is cut.

    zstandard's own reader says nothing of a cut file, and stops after the first zstd frame.
    """

    CHUNK = 1 << 17  # compressed bytes

    def __init__(self, path):
        self._file = open(path, "rb")
        self._decoder = None
        self._bytes = memoryview(b"")

    def readable(self):
        return True

    def readinto(self, buffer):
        while not self._bytes:
            data = self._file.read(self.CHUNK)
            if not data:
                if self._decoder is not None:
                    raise EOFError("the zstd frame is cut")
                return 0
            self._bytes = memoryview(b"".join(self._decompress(data)))
        count = min(len(buffer), len(self._bytes))
        buffer[:count] = self._bytes[:count]
        self._bytes = self._bytes[count:]
        return count

    def _decompress(self, data):
        while data:
            self._decoder = self._decoder or zstandard.ZstdDecompressor().decompressobj()
            yield self._decoder.decompress(data)
            data = self._decoder.unused_data
            if self._decoder.eof:
                self._decoder = None

    def close(self):
        self._file.close()
        super().close()


def _open_zstd(path, mode, **options):
    return io.TextIOWrapper(io.BufferedReader(_ZstdReader(path)), **options)


OPENERS = {b"\x1f\x8b": gzip.open, b"\x28\xb5\x2f\xfd": _open_zstd}  # by the first bytes of a file


@contextlib.contextmanager
def open_text(path):
    try:
        with open(path, "rb") as probe:
            start = probe.read(4)
        opener = next((OPENERS[magic] for magic in OPENERS if start.startswith(magic)), open)
        with opener(path, "rt", encoding="ascii", errors="replace") as handle:
            yield handle
    except OSError as error:
        raise DumpError(f"{path}: {error.strerror or error}") from error
