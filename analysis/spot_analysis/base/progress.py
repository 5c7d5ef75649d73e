# SPDX-License-Identifier: GPL-2.0-or-later
"""Progress of long work on standard error."""

import sys
import time


class Progress:
    """Prints a line every few seconds: what was done so far, how long it took, and how long it will take where that is known.

    label : what is being done, e.g. "DEM"
    period : seconds between two lines
    terminal_only : say nothing where standard error is no terminal
    """

    def __init__(self, label, period=5.0, terminal_only=False):
        self._label = label
        self._period = period if not terminal_only or sys.stderr.isatty() else float("inf")
        self._start = self._last = time.monotonic()

    def __call__(self, text, share=None):
        """share : part of the work that is done, 0 to 1"""
        now = time.monotonic()
        if now - self._last >= self._period:
            left = f", about {(now - self._start) * (1 / share - 1):.0f} s left" if share else ""
            self._print(text + left, now)

    def finish(self, text):
        self._print(text, time.monotonic())

    def _print(self, text, now):
        self._last = now
        print(f"{self._label}: {text} ({now - self._start:.0f} s)", file=sys.stderr, flush=True)
