# SPDX-License-Identifier: GPL-2.0-or-later
"""Runs of a deck of the spot model whose statistics are kept, so that what was run once is not run again."""

import hashlib
import json
import os
import shlex
import shutil
import subprocess

from ..base.errors import AnalysisError
from ..reading.log import reason_of_failure
from ..reading.scene import load_scene
from ..statistics import run_statistics
from ..statistics.measuring import measure_dumps
from .command_line import print_warning


def run_deck(lmp, deck, variables, dumps, label):
    """Run ``deck`` in its own folder, with its snapshots in ``dumps``; raises AnalysisError where it fails.

    lmp : command; variables : name -> text, of the deck; label : for the error
    """
    words = [word for key, value in {**variables, "out": os.path.abspath(dumps)}.items() for word in ("-var", key, value)]
    done = subprocess.run([*shlex.split(lmp), "-in", os.path.basename(deck), "-log", "none", *words],
                          cwd=os.path.dirname(os.path.abspath(deck)), capture_output=True, text=True)
    if done.returncode != 0:
        raise AnalysisError(f"lmp failed on '{label}': {reason_of_failure(done.stdout + done.stderr)}")


def remove(dumps):
    """Remove a folder of dumps, if there is one."""
    shutil.rmtree(dumps, ignore_errors=True)


def settings_of(deck, variables, times=None):
    """One line that two runs share if they are the same: the deck's text, with the files that it includes by name, its variables,
    the times that are measured."""
    text = hashlib.sha256(b"".join(_texts(deck))).hexdigest()
    chosen = None if times is None else [f"{time:.2f}" for time in times]
    return json.dumps({"deck": text, "variables": variables, "times": chosen}, sort_keys=True)


def _texts(deck):
    with open(deck, "rb") as handle:
        text = handle.read()
    yield text
    for line in text.decode(errors="replace").splitlines():
        path = os.path.join(os.path.dirname(deck), *line.split()[1:2])
        if line.split()[:1] == ["include"] and os.path.isfile(path):
            with open(path, "rb") as handle:
                yield handle.read()


def kept(stored, settings, label, make, concepts=run_statistics.CONCEPTS, times=None, keep_dumps=False):
    """RunStatistics of the file ``stored``, which is made if it is not there: ``make`` is called with a folder for the dumps.

    settings : what the file has to be made with; raises AnalysisError where it was made with others
    concepts, times : what is measured, see ``measure_dumps``
    """
    if os.path.exists(stored):
        run = run_statistics.load(stored)
        if run.provenance.get("settings") != settings:
            raise AnalysisError(f"{stored}: made by another deck, with other variables or for other times; choose another folder")
        return run
    dumps = stored.removesuffix(".npz")
    remove(dumps)  # snapshots of a run that was interrupted
    make(dumps)
    run = measure_dumps(dumps, load_scene(dumps), label, {"source": label, "settings": settings}, print_warning, concepts, times)
    run.save(f"{stored}.part")
    os.replace(f"{stored}.part", stored)
    if not keep_dumps:
        remove(dumps)
    return run_statistics.load(stored)  # as later calls do: the file has single precision
