# SPDX-License-Identifier: GPL-2.0-or-later
"""How long small and large grains take from a level to the orifice."""

import numpy as np

LEVEL = 5.0  # d


def residence(snapshots, start, end):
    """For small and for large grains, the medians, tau, a pair of snapshots each, of what those that leave have taken.

    snapshots : as of ``mixture``, from the opening on; start, end : the pairs' interval, tau
    """
    passed, medians = {}, ([], [])
    for before, after in zip(snapshots, snapshots[1:]):
        later = dict(zip(after.ids.tolist(), after.positions[:, 2].tolist()))
        stayed = ([], [])
        for grain, height, large in zip(before.ids.tolist(), before.positions[:, 2].tolist(), before.large.tolist()):
            now = later.get(grain, -np.inf)
            if height >= LEVEL > now and grain not in passed:
                share = (height - LEVEL) / (height - max(now, 0.0))
                passed[grain] = before.time + share * (after.time - before.time)
            if height > 0.0 >= now and grain in passed:
                stayed[large].append((before.time + after.time) / 2 - passed[grain])
        if start <= before.time and after.time <= end:
            for kind in (0, 1):
                if stayed[kind]:
                    medians[kind].append(np.median(stayed[kind]))
    return medians
