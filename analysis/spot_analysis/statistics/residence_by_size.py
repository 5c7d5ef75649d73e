# SPDX-License-Identifier: GPL-2.0-or-later
"""How long small and large grains take from a level to the orifice."""

import numpy as np

from .passages import residence_times

LEVEL = 5.0  # d


def residence(snapshots, start, end):
    """For small and for large grains, the medians, tau, a pair of snapshots each, of what those that leave have taken.

    snapshots : as of ``mixture``, from the opening on; start, end : the pairs' interval, tau
    """
    medians = ([], [])
    for before, after, who, stayed in residence_times(snapshots, LEVEL):
        if start <= before.time and after.time <= end:
            for kind in (0, 1):
                ones = stayed[before.large[who] == kind]
                if len(ones):
                    medians[kind].append(np.median(ones))
    return medians
