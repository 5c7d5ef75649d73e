# SPDX-License-Identifier: GPL-2.0-or-later
"""Collects what is measured on one snapshot after the other."""

import math
from types import SimpleNamespace

import numpy as np

from . import flow, neighbours, radial_distribution, structure
from .front_layer import FrontLayer
from .history import History
from .region import structure_region
from .run_statistics import RunStatistics
from .scene_fit import require_diameter
from .snapshot import LAG_TAU, Snapshot

PROFILE_HEIGHTS = np.array([5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 50.0, 60.0, 70.0])


class Recorder:
    """Collects the statistics while frames go by; keeps those of the last LAG_TAU only."""

    def __init__(self, scene, concepts):
        self.times = []
        self._scene = scene
        self._container = scene.container()
        self._region = structure_region(self._container)
        self._history = History(LAG_TAU)
        self._concepts = {one.NAME: one.Measurement(self._container, self._region) for one in concepts}
        self._snapshots = []
        self._profiles = []
        self._front_layer = FrontLayer(self._container)

    def add(self, frame):
        require_diameter(self._scene, frame)
        time = round(self._scene.time(frame.timestep), 6)
        positions = self._scene.positions(frame.positions)
        if not self.times:
            self._start(positions)
        self.times.append(time)
        snapshot = Snapshot(time, frame.ids, positions, self._container, self._region)
        self._history.add(snapshot)
        self._snapshots.append(self._numbers(snapshot))
        self._add_profile(snapshot)
        for concept in self._concepts.values():
            concept.add(snapshot, self._history)
        snapshot.forget()
        self._front_layer.add(snapshot, self._history.first)

    def _start(self, positions):
        self.lowest = positions[:, 2].min(initial=math.inf)
        self._edges = np.linspace(-1, 1, max(int(round(2 * self._container.half_width)), 1) + 1) \
            * self._container.half_width

    def _numbers(self, snapshot):
        """Numbers of one snapshot by their names in RunStatistics."""
        positions = snapshot.positions
        inside = positions[positions[:, 2] > 0]
        values = {
            "grains": len(snapshot.ids),
            "above": flow.count_above(positions[:, 2], _levels_up_to(positions[:, 2].max(initial=0))),
            "outside": int(self._container.outside(positions).sum()),
            "largest_wall_overlap": float(self._container.wall_overlap(positions).max(initial=0)),
            "largest_overlap": neighbours.largest_overlap(inside, self._container.period),
            "region_grains": int(self._region.contains(positions).sum()),
            "region_largest_overlap": math.nan,
            "contacts": math.nan,
            "badness": math.nan,
            "rdf_counts": np.zeros(len(radial_distribution.RDF_EDGES) - 1, dtype=np.int64),
        }
        if snapshot.is_covered:
            pairs = snapshot.pairs
            values.update(
                region_largest_overlap=float(max(1 - pairs.distance.min(initial=1), 0)),
                contacts=structure.contacts_per_grain(pairs),
                badness=structure.badness(pairs),
                rdf_counts=radial_distribution.rdf_counts(pairs),
            )
        return values

    def _add_profile(self, snapshot):
        """Velocities from the snapshot LAG_TAU ago, if there is one."""
        start = self._history.earlier(LAG_TAU)
        if start is not None:
            first, second = flow.common_grains(start.ids, snapshot.ids)
            self._profiles.append((start.time, snapshot.time, *flow.velocity_profile(
                start.positions[first], snapshot.positions[second], snapshot.time - start.time, PROFILE_HEIGHTS,
                self._edges)))

    def statistics(self, provenance):
        levels = max((len(snapshot["above"]) for snapshot in self._snapshots))
        for snapshot in self._snapshots:  # nothing is above the highest grain
            snapshot["above"] = np.pad(snapshot["above"], (0, levels - len(snapshot["above"])))
        series = {name: np.array([snapshot[name] for snapshot in self._snapshots]) for name in self._snapshots[0]}
        bins = (0, len(PROFILE_HEIGHTS), len(self._edges) - 1)
        profiles = list(zip(*self._profiles)) or [[], [], np.empty(bins, dtype=np.int64), np.empty(bins)]
        measured = {name: SimpleNamespace(**concept.arrays()) for name, concept in self._concepts.items()}
        return RunStatistics(
            scene=self._scene, measured=measured, provenance=provenance, times=np.array(self.times),
            levels=np.arange(levels, dtype=float),
            rdf_edges=radial_distribution.RDF_EDGES, profile_heights=PROFILE_HEIGHTS, profile_edges=self._edges,
            profile_start=np.array(profiles[0]), profile_end=np.array(profiles[1]),
            profile_counts=np.array(profiles[2]), profile_sums=np.array(profiles[3]),
            **self._front_layer.arrays(), **series)


def _levels_up_to(height):
    return np.arange(math.ceil(height) + 1, dtype=float)
