# SPDX-License-Identifier: GPL-2.0-or-later
"""Progress of long work on standard error, where that is a terminal."""

import sys
import time


class Progress:
    """Prints a line every few seconds: what was done so far, how long that took, and how much longer if known.

    label : what is being done, e.g. "DEM"
    period : seconds between two lines

    Says nothing where standard error is no terminal, but a file or a pipe.
    """

    def __init__(self, label, period=5.0):
        self._label = label
        self._period = period
        self._quiet = not sys.stderr.isatty()
        self._start = self._last = time.monotonic()

    def __call__(self, text, share=None):
        """share : part of the work that is done, 0 to 1; None where that is not known"""
        now = time.monotonic()
        if now - self._last >= self._period:
            left = f", about {(now - self._start) * (1 / share - 1):.0f} s left" if share else ""
            self._print(text + left, now)

    def finish(self, text):
        self._print(text, time.monotonic())

    def _print(self, text, now):
        self._last = now
        if not self._quiet:
            print(f"{self._label}: {text} ({now - self._start:.0f} s)", file=sys.stderr, flush=True)


def share_of(done, total):
    """Part of the work that is done; None where ``total`` does not tell, as of one file, which may hold many frames."""
    return min(done / total, 1.0) if total > 1 else None


def counted(items, total, what):
    """Yields ``items`` with lines on how many of ``total`` there were; what : they are, such as "runs"."""
    progress = Progress(what)
    for number, item in enumerate(items, 1):
        progress(f"{number} of {total} done", number / total)
        yield item
