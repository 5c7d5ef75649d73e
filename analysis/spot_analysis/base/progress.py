# SPDX-License-Identifier: GPL-2.0-or-later
"""Progress of long work on standard error."""

import sys
import time


class Progress:
    """Prints a line every few seconds: what was done so far and how long it took.

    label : what is being done, e.g. "DEM"
    period : seconds between two lines
    """

    def __init__(self, label, period=5.0):
        self._label = label
        self._period = period
        self._start = self._last = time.monotonic()

    def __call__(self, text):
        now = time.monotonic()
        if now - self._last >= self._period:
            self._print(text, now)

    def finish(self, text):
        self._print(text, time.monotonic())

    def _print(self, text, now):
        self._last = now
        print(f"{self._label}: {text} ({now - self._start:.0f} s)", file=sys.stderr, flush=True)
