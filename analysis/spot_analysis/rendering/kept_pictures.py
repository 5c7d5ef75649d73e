# SPDX-License-Identifier: GPL-2.0-or-later
"""The file that keeps pictures of a run."""

import json
import zipfile

import numpy as np

from ..base.errors import AnalysisError
from ..reading.container import Container
from ..reading.hopper import Hopper
from ..statistics import run_statistics
from .pictures import Picture, Reel

FORMAT = "spot-analysis pictures 1"
QUANTUM = run_statistics.PICTURE_QUANTUM  # d


def save_pictures(path, reel):
    """Write a Reel; positions and diameters to QUANTUM."""
    header = {"format": FORMAT, "colour": reel.colour, "colour_label": reel.colour_label, "tau": reel.tau,
              "container": vars(reel.container) if reel.container else None}
    # neighbours in the file look alike when sorted by height, so it compresses better; a layer hides nothing
    orders = [np.argsort(picture.z, kind="stable") for picture in reel.pictures]
    columns = {name: np.concatenate([getattr(picture, name)[order] for picture, order in zip(reel.pictures, orders)])
               for name in ("x", "z", "diameters", "values")}
    lengths = {name: np.rint(columns[name] / QUANTUM).astype(np.int32) for name in ("x", "z", "diameters")}
    with open(path, "wb") as handle:
        np.savez_compressed(handle, header=json.dumps(header), times=[picture.time for picture in reel.pictures],
                            sizes=[len(picture.x) for picture in reel.pictures],
                            values=columns["values"].astype(np.float16), **lengths)


def load_pictures(label, path, wanted):
    """The Reel in ``path``: kept pictures, or those of the front layer in a statistics file."""
    try:
        with np.load(path, allow_pickle=False) as stored:
            header = json.loads(str(stored["header"]))
            if header["format"] != FORMAT:
                return _of_statistics(label, path, wanted)
            container = _container(header["container"])
            ends = np.cumsum(stored["sizes"])
            columns = [np.split(stored[name], ends[:-1]) for name in ("x", "z", "diameters", "values")]
            times = stored["times"]
    except OSError as error:
        raise AnalysisError(f"{path}: {error.strerror or error}") from error
    except (EOFError, KeyError, TypeError, ValueError, zipfile.BadZipFile) as error:
        raise AnalysisError(f"{path}: neither pictures kept by render.py nor statistics of measure.py ({error})") from error
    pictures = [Picture(float(time), x * QUANTUM, z * QUANTUM, diameters * QUANTUM, values.astype(float))
                for time, x, z, diameters, values in zip(times, *columns) if wanted(time)]
    return Reel(label, header["colour"], header["colour_label"], container, header["tau"], pictures)


def _container(values):
    """Of a file's header; values : of the walls by their names, None where they are unknown"""
    return values and (Hopper if "cylinder_radius" in values else Container)(**values)


def _of_statistics(label, path, wanted):
    run = run_statistics.load(path)
    pictures = []
    for index, time in enumerate(run.picture_times):
        x, z, layer = run.picture(index)
        if wanted(time):
            pictures.append(Picture(float(time), x, z, np.ones(len(x)), np.where(layer < 0, np.nan, layer)))
    return Reel(label, "layer", None, run.scene.container(), True, pictures)
