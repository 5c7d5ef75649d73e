# SPDX-License-Identifier: GPL-2.0-or-later
"""<N>, the mean number of grains in a spot, counted in spheres laid where spots go; d."""

import numpy as np
from scipy.spatial import cKDTree

from .calibration_estimate import Estimate, estimate

SPOT_POINTS = 300  # places of a spot in each snapshot
SPOT_HEIGHTS = (15.0, 60.0)
SPOT_RADII = np.arange(1.2, 5.001, 0.2)


def measure_spot_grains(tracks, spreading_line, buffer, seed=1):
    """Table of the mean number of grains in a sphere of each of SPOT_RADII, laid where spots go: Estimate (r,).

    spreading_line : slope and intercept of the spots' variance in x against height

    Spots are a Gaussian in x and even in y, between walls that their centres keep ``buffer`` from, so the walls cut their
    influence as they cut that of the model's spots.
    """
    rng = np.random.default_rng(seed)
    counts = []
    for index in range(len(tracks.times)):
        centres = spot_places(rng, SPOT_POINTS, tracks.container, spreading_line, buffer)
        counts.append(_mean_counts(tracks.frame(index), centres))
    return estimate(tracks.times, np.column_stack([counts, np.ones(len(counts))]), tracks.span,
                    lambda sums: sums[..., :-1] / sums[..., -1:])


def spot_places(rng, number, container, spreading_line, buffer):
    """(number, 3) centres of spots at random heights."""
    slope, intercept = spreading_line
    z = rng.uniform(*SPOT_HEIGHTS, number)
    x = rng.normal(0, np.sqrt(np.maximum(slope * z + intercept, 1)))
    reach = container.half_width - buffer
    x = reach - np.abs((x + reach) % (4 * reach) - 2 * reach)  # reflected at +-reach
    y = rng.uniform(-1, 1, number) * (container.half_depth - buffer)
    return np.column_stack([x, y, z])


def _mean_counts(positions, centres):
    tree = cKDTree(positions)
    distances = [np.linalg.norm(positions[near] - centre, axis=1)
                 for near, centre in zip(tree.query_ball_point(centres, SPOT_RADII[-1]), centres)]
    return np.searchsorted(np.sort(np.concatenate(distances)), SPOT_RADII) / len(centres)


def grains_within(table, radius):
    """Estimate of <N> at the Estimate ``radius``, by interpolation of N / R^3 in the table."""
    density = Estimate(table.value / SPOT_RADII**3, table.replicates / SPOT_RADII**3)
    value = np.interp(radius.value, SPOT_RADII, density.value) * radius.value**3
    place = np.interp(radius.replicates, SPOT_RADII, np.arange(len(SPOT_RADII)))
    low = np.floor(place).astype(int).clip(0, len(SPOT_RADII) - 2)
    rows, share = np.arange(len(place)), place - low
    replicates = density.replicates[rows, low] * (1 - share) + density.replicates[rows, low + 1] * share
    return Estimate(value, replicates * radius.replicates**3)


def cut_share(container, radius, buffer, points=400):
    """Share of a spot's sphere that lies between the walls at y = +-half_depth, mean over even centres (2006 has 1)."""
    y = (np.arange(points) + 0.5) / points * (container.half_depth - buffer)
    missing = np.maximum(radius - (container.half_depth - y), 0)
    cap = np.pi * missing**2 * (3 * radius - missing) / 3
    return float(1 - (cap / (4 / 3 * np.pi * radius**3)).mean())
