# SPDX-License-Identifier: GPL-2.0-or-later
"""The lines of a file with their numbers, so that an error can say where it is."""

import itertools

from ..base.errors import DumpError, TruncatedFrame
from .compression import DAMAGED

CUT = "the run was stopped or the disk was full while it was written; write it again, or take the cut frame out of it"


class Lines:
    """The lines of one file with their number, for error messages."""

    def __init__(self, path, handle):
        self.path = path
        self.number = 0
        self._handle = handle

    def take(self, count):
        """The next ``count`` lines, fewer at the end of the file."""
        try:
            lines = list(itertools.islice(self._handle, count))
        except EOFError as error:
            raise TruncatedFrame(f"{self.path}: the compressed file ends after line {self.number}: {CUT}") from error
        except DAMAGED as error:
            raise DumpError(f"{self.path}: damaged compressed data after line {self.number} ({error})") from error
        self.number += len(lines)
        return lines

    def need(self, count, what):
        """The next ``count`` lines; a last line without its end counts as cut off."""
        lines = self.take(count)
        if len(lines) < count or not lines[-1].endswith("\n"):
            raise self.cut(f"{what} ({len(lines)} of {count} lines)")
        return lines

    def cut(self, what):
        return TruncatedFrame(f"{self.path}, line {self.number}: the file ends inside {what}: {CUT}")

    def error(self, message, line=None):
        return DumpError(f"{self.path}, line {line or self.number}: {message}")
