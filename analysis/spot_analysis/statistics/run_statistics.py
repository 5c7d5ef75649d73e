# SPDX-License-Identifier: GPL-2.0-or-later
"""Everything that is measured on the dumps of one run, snapshot by snapshot, and the file that stores it.

A statistics file holds what a comparison over any interval needs, in a few hundred kB: no dump is read again.
"""

import json
import math
import zipfile
import zlib
from dataclasses import dataclass, fields
from types import SimpleNamespace

import numpy as np

from ..base.errors import AnalysisError, DumpError, SceneError
from ..base.progress import Progress
from ..reading.container import structure_region
from ..reading.dump import find_dumps, read_frames
from ..reading.scene import Scene, scene_of
from . import (bond_angles, bond_order, flow, free_surface, mixing, particle_diffusion, residence, structure, thickness,
               velocity_correlation, voronoi)
from .snapshot import LAG_TAU, TIME_TOLERANCE, History, Snapshot

FORMAT = "spot-analysis run statistics 3"
# Each has a NAME and a class Measurement: add(snapshot, history) for each snapshot in turn, then arrays(), which go to
# RunStatistics.measured[NAME].
CONCEPTS = (velocity_correlation, particle_diffusion, bond_angles, bond_order, free_surface, thickness, voronoi,
            residence, mixing)
PROFILE_HEIGHTS = np.array([5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 50.0, 60.0, 70.0])
PICTURE_PERIOD = 10.0  # tau; after PICTURE_MANY only every PICTURE_SPARSE
PICTURE_MANY = 100.0
PICTURE_SPARSE = 100.0
PICTURE_QUANTUM = 0.01  # d
LAYER_HEIGHT = 10.0  # d
BASE_GAP = 1.0  # d; centres of grains at rest on a base are lower


@dataclass
class RunStatistics:
    """Statistics of one run. T snapshots, L levels, P pairs of snapshots LAG_TAU apart; units d, tau, grains.

    scene : units and geometry
    provenance : text -> text, where the dumps came from
    times : (T,)
    grains : (T,) in the dump
    levels : (L,) heights, 0, 1, 2 ... d, up to the highest grain of all snapshots
    above : (T, L) grains above each level
    outside : (T,) grains outside the container
    largest_wall_overlap, largest_overlap : (T,) anywhere above z = 0
    region_grains : (T,) in the region of ``structure_region``
    region_largest_overlap, contacts, badness : (T,) there; not a number where the region is not full
    rdf_edges : (K + 1,); rdf_counts : (T, K) partners, summed over the region's grains, 0 where it is not full
    profile_heights : (H,); profile_edges : (X + 1,)
    profile_start, profile_end : (P,) times
    profile_counts, profile_sums : (P, H, X) grains and sums of their downward velocity
    picture_times : (Q,); picture_sizes : (Q,) grains in each picture
    picture_x, picture_z : positions of the front layer's grains in PICTURE_QUANTUM, one picture after the other
    picture_layer : layer of LAYER_HEIGHT in which each of them started, -1 for those that came later
    measured : the arrays of each of CONCEPTS under its NAME; its class Measurement says which
    """

    scene: Scene
    provenance: dict
    times: np.ndarray
    grains: np.ndarray
    levels: np.ndarray
    above: np.ndarray
    outside: np.ndarray
    largest_wall_overlap: np.ndarray
    largest_overlap: np.ndarray
    region_grains: np.ndarray
    region_largest_overlap: np.ndarray
    contacts: np.ndarray
    badness: np.ndarray
    rdf_edges: np.ndarray
    rdf_counts: np.ndarray
    profile_heights: np.ndarray
    profile_edges: np.ndarray
    profile_start: np.ndarray
    profile_end: np.ndarray
    profile_counts: np.ndarray
    profile_sums: np.ndarray
    picture_times: np.ndarray
    picture_sizes: np.ndarray
    picture_x: np.ndarray
    picture_z: np.ndarray
    picture_layer: np.ndarray
    measured: dict

    def region(self):
        return structure_region(self.scene.container())

    def count_above(self, level):
        """(T,) grains above ``level``, one of ``levels``; 0 above the highest."""
        index = np.searchsorted(self.levels, level)
        return self.above[:, index] if index < len(self.levels) else np.zeros(len(self.times), dtype=np.int64)

    def picture(self, index):
        """(x, z, layer) of the front layer in picture number ``index``."""
        start = int(self.picture_sizes[:index].sum())
        part = slice(start, start + int(self.picture_sizes[index]))
        return (self.picture_x[part] * PICTURE_QUANTUM, self.picture_z[part] * PICTURE_QUANTUM,
                self.picture_layer[part])

    def save(self, path):
        header = {"format": FORMAT, "scene": self.scene.as_dict(), "provenance": self.provenance}
        arrays = {name: _compact(getattr(self, name)) for name in ARRAYS}
        arrays.update({f"{concept}.{name}": _compact(array) for concept, part in self.measured.items()
                       for name, array in vars(part).items()})
        with open(path, "wb") as handle:
            np.savez_compressed(handle, header=json.dumps(header), **arrays)


ARRAYS = tuple(f.name for f in fields(RunStatistics) if f.type is np.ndarray)


def load(path):
    """Read a statistics file; raises AnalysisError where it is not one."""
    try:
        with np.load(path, allow_pickle=False) as stored:
            header = json.loads(str(stored["header"]))
            if header["format"] != FORMAT:
                raise AnalysisError(f"{path}: statistics of another format ('{header['format']}'); "
                                    "measure the dumps again")
            arrays = {name: _roomy(stored[name]) for name in ARRAYS}
            measured = {concept.NAME: SimpleNamespace() for concept in CONCEPTS}
            for key in stored.files:
                if "." in key:
                    concept, name = key.split(".")
                    setattr(measured[concept], name, _roomy(stored[key]))
            scene = scene_of(header["scene"])
    except SceneError as error:
        raise AnalysisError(f"{path}: {error}") from error
    except OSError as error:
        raise AnalysisError(f"{path}: {error.strerror or error}") from error
    except (EOFError, KeyError, TypeError, ValueError, zipfile.BadZipFile, zlib.error) as error:
        raise AnalysisError(f"{path}: not a statistics file of measure.py, or a damaged one ({error})") from error
    return RunStatistics(scene, header["provenance"], measured=measured, **arrays)


def _compact(array):
    """The smallest integers that hold the values; single precision for measured numbers."""
    if array.dtype.kind in "iu" and array.size:
        low, high = int(array.min()), int(array.max())
        return array.astype(np.promote_types(np.min_scalar_type(low), np.min_scalar_type(high)))
    return array.astype(np.float32) if array.ndim > 1 else array


def _roomy(array):
    return array.astype(np.int64) if array.dtype.kind in "iu" else array.astype(np.float64)


def measure(source, scene, label="dumps", provenance=None, warn=print, concepts=CONCEPTS):
    """Measure the dumps ``source`` (see ``dump.find_dumps``).

    label : for the progress lines
    warn : called with a line for frames that are left out, and for a scene that does not seem to be that of the dumps
    concepts : those of CONCEPTS to measure

    Snapshots before the opening of the orifice are left out. Raises DumpError, SceneError.
    """
    files = len(find_dumps(source))
    progress = Progress(label)
    recorder = _Recorder(scene, concepts)
    early = 0
    for number, frame in enumerate(read_frames(source, extra=("radius",), warn=warn), 1):
        if scene.time(frame.timestep) < -TIME_TOLERANCE:
            early += 1
            continue
        recorder.add(frame)
        total = f" of {files}" if files > 1 else ""
        progress(f"{number} snapshots{total}, t = {recorder.times[-1]:g} tau")
    if not recorder.times:
        raise DumpError(f"{source}: all {early} snapshots are from before the orifice opens, at {scene.opening_time:g} "
                        "(opening_time)")
    if early:
        warn(f"{source}: {early} snapshots from before the orifice opens, at {scene.opening_time:g} (opening_time), are left out")
    if abs(recorder.times[0]) > TIME_TOLERANCE:
        warn(f"{source}: the first snapshot is at t = {recorder.times[0]:g} tau; the density drop and the colours of "
             "the layers are relative to it, not to the start")
    progress.finish(f"{len(recorder.times)} snapshots measured, "
                    f"t = {recorder.times[0]:g} to {recorder.times[-1]:g} tau")
    statistics = recorder.statistics(provenance or {})
    _warn_of_misfit(source, statistics, recorder.lowest, warn)
    return statistics


def _warn_of_misfit(source, run, lowest, warn):
    """Grains outside the walls, or a first snapshot that ends far above the base, mean another scene than that of the dumps."""
    if run.outside.max() > 0:
        most = int(run.outside.argmax())
        warn(f"{source}: {run.outside[most]} of {run.grains[most]} grains are outside the walls and the base of the scene at "
             f"t = {run.times[most]:g} tau")
    if BASE_GAP < lowest < math.inf:
        warn(f"{source}: the lowest grain of the first snapshot lies {lowest:g} d above the base of the scene, from which all "
             "heights count; 'base_z' says where the base is")


class _Recorder:
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
        self._pictures = []

    def add(self, frame):
        self._check(frame)
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
        if _is_picture_time(time):
            self._pictures.append((time, *self._front_layer(snapshot)))

    def _start(self, positions):
        self.lowest = positions[:, 2].min(initial=math.inf)
        self._edges = np.linspace(-1, 1, max(int(round(2 * self._container.half_width)), 1) + 1) \
            * self._container.half_width
        self._initial_layer = np.maximum(positions[:, 2] / LAYER_HEIGHT, 0).astype(np.int64)

    def _check(self, frame):
        """The scene must fit the dump: a wrong diameter makes every number wrong."""
        diameter = self._scene.diameter
        radius = frame.extra.get("radius")
        if radius is not None and np.any(np.abs(2 * radius / diameter - 1) > 1e-3):
            odd = np.argmax(np.abs(2 * radius / diameter - 1))
            raise SceneError(f"grain {frame.ids[odd]} has radius {radius[odd]:g}, "
                             f"but the scene's diameter is {diameter:g}")
        if len(frame.ids) < 2:
            return
        extent = np.ptp(frame.positions, axis=0) + diameter
        if len(frame.ids) * math.pi / 6 * diameter**3 > extent.prod():
            raise SceneError(f"the scene's diameter {diameter:g} does not fit the dump: {len(frame.ids)} such grains "
                             f"have more volume than the box of {extent[0]:.3g} x {extent[1]:.3g} x {extent[2]:.3g} "
                             "they lie in")

    def _numbers(self, snapshot):
        """Numbers of one snapshot by their names in RunStatistics."""
        positions = snapshot.positions
        inside = positions[positions[:, 2] > 0]
        values = {
            "grains": len(snapshot.ids),
            "above": flow.count_above(positions[:, 2], _levels_up_to(positions[:, 2].max(initial=0))),
            "outside": int(self._container.outside(positions).sum()),
            "largest_wall_overlap": float(self._container.wall_overlap(positions).max(initial=0)),
            "largest_overlap": structure.largest_overlap(inside),
            "region_grains": int(self._region.contains(positions).sum()),
            "region_largest_overlap": math.nan,
            "contacts": math.nan,
            "badness": math.nan,
            "rdf_counts": np.zeros(len(structure.RDF_EDGES) - 1, dtype=np.int64),
        }
        if snapshot.is_covered:
            pairs = snapshot.pairs
            values.update(
                region_largest_overlap=float(max(1 - pairs.distance.min(initial=1), 0)),
                contacts=structure.contacts_per_grain(pairs),
                badness=structure.badness(pairs),
                rdf_counts=structure.rdf_counts(pairs),
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

    def _front_layer(self, snapshot):
        """x, z (PICTURE_QUANTUM) and starting layer of the grains at the wall y = -half_depth."""
        positions = snapshot.positions
        front = (positions[:, 1] < 1 - self._container.half_depth) & (positions[:, 2] > -1)
        place = self._history.first.index_of(snapshot.ids[front])
        layer = np.full(len(place), -1)
        layer[place >= 0] = self._initial_layer[place[place >= 0]]
        x, _, z = np.rint(positions[front] / PICTURE_QUANTUM).astype(np.int64).T
        order = np.argsort(z, kind="stable")  # neighbours in the file look alike, so it compresses better
        return x[order], z[order], layer[order]

    def statistics(self, provenance):
        levels = max((len(snapshot["above"]) for snapshot in self._snapshots))
        for snapshot in self._snapshots:  # nothing is above the highest grain
            snapshot["above"] = np.pad(snapshot["above"], (0, levels - len(snapshot["above"])))
        series = {name: np.array([snapshot[name] for snapshot in self._snapshots]) for name in self._snapshots[0]}
        bins = (0, len(PROFILE_HEIGHTS), len(self._edges) - 1)
        profiles = list(zip(*self._profiles)) or [[], [], np.empty(bins, dtype=np.int64), np.empty(bins)]
        pictures = list(zip(*self._pictures)) or [[], [], [], []]
        x, z, layer = (np.concatenate([np.empty(0, dtype=np.int64), *part]) for part in pictures[1:])
        measured = {name: SimpleNamespace(**concept.arrays()) for name, concept in self._concepts.items()}
        return RunStatistics(
            scene=self._scene, measured=measured, provenance=provenance, times=np.array(self.times),
            levels=np.arange(levels, dtype=float),
            rdf_edges=structure.RDF_EDGES, profile_heights=PROFILE_HEIGHTS, profile_edges=self._edges,
            profile_start=np.array(profiles[0]), profile_end=np.array(profiles[1]),
            profile_counts=np.array(profiles[2]), profile_sums=np.array(profiles[3]),
            picture_times=np.array(pictures[0]),
            picture_sizes=np.array([len(part) for part in pictures[1]], dtype=np.int64),
            picture_x=x, picture_z=z, picture_layer=layer, **series)


def _levels_up_to(height):
    return np.arange(math.ceil(height) + 1, dtype=float)


def _is_picture_time(time):
    period = PICTURE_PERIOD if time < PICTURE_MANY + TIME_TOLERANCE else PICTURE_SPARSE
    return abs(time - period * round(time / period)) <= TIME_TOLERANCE
