# SPDX-License-Identifier: GPL-2.0-or-later
"""Everything that was measured on the dumps of one run, snapshot by snapshot, and the file that stores it.

A statistics file holds what a comparison over any interval needs, in a few hundred kB: no dump is read again.
"""

import json
import zipfile
import zlib
from dataclasses import dataclass, fields
from types import SimpleNamespace

import numpy as np

from ..base.errors import AnalysisError, SceneError
from ..reading.scene import Scene, scene_of
from . import (bond_angles, bond_order, frame_correlation, free_surface, mixing, particle_diffusion, residence, thickness,
               velocity_correlation, voronoi)
from .region import structure_region

FORMAT = "spot-analysis run statistics 4"
# Files whose dumps are gone stay readable: format -> NAME of the concepts that came later, which such a file lacks.
OLDER = {"spot-analysis run statistics 3": (frame_correlation.NAME,)}
# Each has a NAME and a class Measurement: add(snapshot, history) for each snapshot in turn, then arrays(), which go to
# RunStatistics.measured[NAME].
CONCEPTS = (velocity_correlation, frame_correlation, particle_diffusion, bond_angles, bond_order, free_surface, thickness, voronoi,
            residence, mixing)
PICTURE_QUANTUM = 0.01  # d


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
    picture_layer : layer of ``front_layer.LAYER_HEIGHT`` in which each of them started, -1 for those that came later
    measured : the arrays of each of CONCEPTS under its NAME; its class Measurement says which
    lacking : NAME of those that a file of an older format does not have; their arrays are empty
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
    lacking: tuple = ()

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
        header = {"format": FORMAT, "scene": self.scene.as_dict(), "provenance": self.provenance, "lacking": self.lacking}
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
            if header["format"] not in (FORMAT, *OLDER):
                raise AnalysisError(f"{path}: statistics of another format ('{header['format']}'); "
                                    "measure the dumps again")
            arrays = {name: _roomy(stored[name]) for name in ARRAYS}
            measured = {concept.NAME: SimpleNamespace() for concept in CONCEPTS}
            for key in stored.files:
                if "." in key:
                    concept, name = key.split(".")
                    setattr(measured[concept], name, _roomy(stored[key]))
            scene = scene_of(header["scene"])
            lacking = tuple(header.get("lacking", OLDER.get(header["format"], ())))
    except SceneError as error:
        raise AnalysisError(f"{path}: {error}") from error
    except OSError as error:
        raise AnalysisError(f"{path}: {error.strerror or error}") from error
    except (EOFError, KeyError, TypeError, ValueError, zipfile.BadZipFile, zlib.error) as error:
        raise AnalysisError(f"{path}: not a statistics file of measure.py, or a damaged one ({error})") from error
    for concept in CONCEPTS:
        if concept.NAME in lacking:
            nothing = concept.Measurement(scene.container(), structure_region(scene.container()))
            measured[concept.NAME] = SimpleNamespace(**nothing.arrays())
    return RunStatistics(scene, header["provenance"], measured=measured, lacking=lacking, **arrays)


def _compact(array):
    """The smallest integers that hold the values; single precision for measured numbers."""
    if array.dtype.kind in "iu" and array.size:
        low, high = int(array.min()), int(array.max())
        return array.astype(np.promote_types(np.min_scalar_type(low), np.min_scalar_type(high)))
    return array.astype(np.float32) if array.ndim > 1 else array


def _roomy(array):
    return array.astype(np.int64) if array.dtype.kind in "iu" else array.astype(np.float64)
