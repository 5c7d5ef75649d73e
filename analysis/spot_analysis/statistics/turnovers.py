# SPDX-License-Identifier: GPL-2.0-or-later
"""How a round bed is turned over, whose grains come in again on top: residence times, profiles of the fall, packing
fraction and mixing.

The unit of time is the turnover, in which as many grains drain as there are: a slow flow without inertia is the same at
any outflow. Lengths are in grain diameters d.
"""

import numpy as np

from .axial_flow import mean_of, speeds_in_rings
from .axial_mixing import mixing
from .axial_packing import fractions_of_layers
from .passages import snapshots_of

HEIGHTS = (8.0, 16.0)  # d, of the profiles
LONGEST = 2.0  # turnovers; how long a stay is known to be, at least, before the run ends
SHARES = {"p05": 0.05, "median": 0.5, "p84": 0.84}  # of the stays, which are shorter
BINS = np.linspace(0.0, LONGEST, 21)  # of their distribution, turnovers
BLOCKS = 4  # of the stays by when they began, for standard errors
MIXED_AFTER = (0.5, 1.0, 2.0)  # turnovers


def measure(frames, scene, start, end):
    """Quantity -> [value, standard error].

    frames : Frames of a run in the order of time; scene : AxialScene
    start, end : the interval of profiles and packing fraction, turnovers; stays are those that began at least ``LONGEST``
    before its end

    Raises ValueError if the run is shorter, fewer than three snapshots lie in the interval, or they do not tell what goes
    round.
    """
    snapshots = snapshots_of(frames, scene)
    turned = np.array([s.rounds.mean() if len(s.rounds) else 0.0 for s in snapshots])
    if len(turned) == 0 or turned[-1] < end * (1 - 1e-2):
        raise ValueError(f"{turned[-1] if len(turned) else 0:.3g} turnovers, but --to is {end:g}")
    if end < LONGEST:
        raise ValueError(f"--to is {end:g}, but stays are followed for {LONGEST:g} turnovers")
    if any(not np.array_equal(s.ids, snapshots[0].ids) for s in snapshots):
        raise ValueError("grains leave for good, or new ones come: in a turned bed all go round")
    used = turned <= end
    snapshots, turned = [s for s, use in zip(snapshots, used) if use], turned[used]
    inside = [s for s, at in zip(snapshots, turned) if at >= start]
    if len(inside) < 3:
        raise ValueError(f"{len(inside)} snapshots between {start:g} and {end:g} turnovers, at least 3 are needed")
    turnover = (inside[-1].time - inside[0].time) / (turned[-1] - turned[len(turned) - len(inside)])

    found = {"turnover": [float(turnover), float("nan")]}
    found.update(_residence(*stays(snapshots, turned)))
    found["never_drained"] = [float(np.mean(snapshots[-1].rounds == 0)), float("nan")]
    pairs = list(zip(inside, inside[1:]))
    for height in HEIGHTS:
        edges, speeds = speeds_in_rings(pairs, height, scene.radius_at(height))
        found.update({f"fall_{height:g}d_r{(low + high) / 2:.1f}d": mean_of(turnover * speeds[:, k])
                      for k, (low, high) in enumerate(zip(edges, edges[1:]))})
    names = [*(f"volume_fraction_{height:g}d" for height in HEIGHTS), "volume_fraction_core"]
    found.update(zip(names, map(mean_of, np.transpose([fractions_of_layers(s, scene, HEIGHTS) for s in inside]))))
    for after in (at for at in MIXED_AFTER if at <= turned[-1]):
        then = snapshots[int(np.argmin(np.abs(turned - after)))]
        indices = mixing(snapshots[0], then)
        found.update({f"{name[:-len('_end')]}_{after:g}": [index, float("nan")]
                      for name, index in indices.items() if name.endswith("_end")})
    return found


def stays(snapshots, turned):
    """(began, lasted) of each time that a grain came in at least ``LONGEST`` before the end, turnovers, (n,); infinity where
    it did not drain again. Between two snapshots it comes in halfway.

    turned : (snapshots,), turnovers by then. All snapshots have the same grains, sorted by id.
    """
    rounds = np.array([s.rounds for s in snapshots])
    halfway = (turned[1:] + turned[:-1]) / 2
    began, lasted = [], []
    for counts in rounds.T:
        came = np.array([halfway[np.searchsorted(counts, k) - 1] for k in range(counts[0] + 1, counts[-1] + 1)])
        began.append(came)
        lasted.append(np.append(came[1:], np.inf)[:len(came)] - came)
    began, lasted = np.concatenate(began), np.concatenate(lasted)
    followed = began <= turned[-1] - LONGEST
    return began[followed], lasted[followed]


def _residence(began, lasted):
    """Quantiles and distribution of the stays; a quantile beyond what all stays are followed for is unknown."""
    order = np.argsort(began, kind="stable")
    blocks = [block for block in np.array_split(lasted[order], BLOCKS) if len(block)]
    found = {}
    for name, share in SHARES.items():
        known = len(lasted) and np.quantile(lasted, share, method="higher") < LONGEST
        found[f"residence_{name}"] = mean_of([np.quantile(block, share, method="higher") for block in blocks] if known else [])
    found["residence_longer"] = mean_of([np.mean(block >= LONGEST) for block in blocks])
    densities = [np.histogram(block, BINS)[0] / len(block) / BINS[1] for block in blocks]
    for k, middle in enumerate((BINS[1:] + BINS[:-1]) / 2):
        found[f"residence_density_{middle:.2f}"] = mean_of([density[k] for density in densities])
    return found
