# SPDX-License-Identifier: GPL-2.0-or-later
"""The snapshots before the present one that measurements look back to."""

from collections import deque

from .snapshot import TIME_TOLERANCE


class History:
    """The first snapshot, the newest, the one before and those of the last ``span`` tau."""

    def __init__(self, span):
        self._span = span
        self._recent = deque()
        self.first = None

    def add(self, snapshot):
        self.first = self.first or snapshot
        self._recent.append(snapshot)
        while len(self._recent) > 2 and self._recent[0].time < snapshot.time - self._span - TIME_TOLERANCE:
            self._recent.popleft()

    @property
    def previous(self):
        """The snapshot before the newest, None if the newest is the first."""
        return self._recent[-2] if len(self._recent) > 1 else None

    def earlier(self, lag):
        """The snapshot ``lag`` tau before the newest; None if there is none."""
        wanted = self._recent[-1].time - lag
        return next((one for one in self._recent if abs(one.time - wanted) <= TIME_TOLERANCE), None)

    def since(self, time):
        """The snapshots from ``time`` to the newest."""
        return [one for one in self._recent if one.time >= time - TIME_TOLERANCE]
