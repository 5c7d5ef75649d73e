# SPDX-License-Identifier: GPL-2.0-or-later
"""How the bed of a hopper mixes: its halves, upper and lower, inner and outer, as they were when the outlet opened."""

import numpy as np

from .lacey import lacey_index


def mixing(first, last):
    """Name -> Lacey's index of the halves in both snapshots: about 0 apart, 1 as by chance.

    first, last : of ``passages``; halves are by the medians in the first, of grains above z = 0. Others do not count.
    """
    start = first.positions[:, 2] > 0
    ids, places = first.ids[start], first.positions[start]
    axis = np.hypot(places[:, 0], places[:, 1])
    found = {}
    for name, place in (("upper_lower", places[:, 2]), ("inner_outer", axis)):
        half = dict(zip(ids.tolist(), (place > np.median(place)).tolist())) if len(ids) else {}
        for when, snapshot in (("start", first), ("end", last)):
            known = (snapshot.positions[:, 2] > 0) & np.isin(snapshot.ids, ids)
            kinds = np.array([half[grain] for grain in snapshot.ids[known].tolist()], dtype=bool)
            found[f"lacey_{name}_{when}"] = lacey_index(snapshot.positions[known], kinds)
    return found
