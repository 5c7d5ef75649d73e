# SPDX-License-Identifier: GPL-2.0-or-later
"""Calibrate the spot model on itself: run the deck with the parameters at hand and see what calibration reads from it."""

import os
import shlex
import subprocess
import tempfile

from ..base.progress import Progress
from ..reading.log import reason_of_failure
from ..reading.scene import load_scene
from ..statistics.interval import STEADY_FROM
from ..statistics.measuring import measure_dumps
from ..statistics.snapshot import LAG_TAU
from .estimate import CalibrationError
from .lammps_variables import IN_THE_DECK, lammps_variables
from .measurement import measure
from .parameters import parameters, response_of
from .view import CONCEPTS


def refine(target, response, rounds, deck, lmp, duration, words="", warn=print, report=print, profile="parabolic"):
    """Parameters for which a spot run shows what was measured in ``target``.

    target : Measured; response : to begin with
    deck, lmp : files; duration : of each run, tau; words : more keywords for fix spot, such as a faster driver's
    report : called with a line after each round
    profile : of the spots

    Each round runs the deck with the present parameters, measures its dumps in the same way, and takes out of the target
    what this run shows against what was put in. Returns parameters and the last response; raises CalibrationError where
    a run fails.
    """
    present = parameters(target, response)
    for number in range(1, rounds + 1):
        put_in = {name: float(value.value) for name, value in present.items()}
        with tempfile.TemporaryDirectory(prefix="calibrate.") as folder:
            variables = lammps_variables(present, "the round before", target.view.interval.span, profile)
            run_deck(deck, lmp, variables, folder, duration, words, Progress(f"round {number}"))
            dumps = os.path.join(folder, "dumps")
            statistics = measure_dumps(dumps, load_scene(dumps), f"round {number}", warn=warn, concepts=CONCEPTS)
            run = measure(statistics, STEADY_FROM, None, target.buffer)
        response = response_of(run, put_in, response)
        present = parameters(target, response)
        report(f"round {number}: a run with " + ", ".join(f"{name} {value:.4g}" for name, value in put_in.items())
               + "; against what was put in it shows "
               + ", ".join(f"{name} {float(value.value):.4g}" for name, value in response.items()))
    return present, response


def deck_text(deck, parameter_file, duration, words):
    """The deck with the file included and the time set before its first parameter, and ``words`` added to its fix spot."""
    with open(deck, encoding="utf-8") as handle:
        commands = handle.read().replace("&\n", " ").splitlines()
    fixes = [place for place, command in enumerate(commands)
             if command.split()[:1] == ["fix"] and command.split()[3:4] == ["spot"]]
    if len(fixes) != 1:
        raise CalibrationError(f"{deck}: {len(fixes)} commands 'fix ID group spot' where one was expected")
    commands[fixes[0]] += f" {words}"
    place = next((place for place, command in enumerate(commands) if _sets_parameters(command.split())), fixes[0])
    return "\n".join([*commands[:place], f"include {parameter_file}", "variable time delete",
                      f"variable time equal {duration:g}*v_tau", *commands[place:], ""])


def _sets_parameters(words):
    """Is this a command that sets the first of the parameters, or includes the file that sets them?"""
    return words[:1] == ["variable"] and words[1:2][0] in ("profile", *IN_THE_DECK) or \
        words[:1] == ["include"] and os.path.basename(words[1]) == "glass-beads.lmp"


def run_deck(deck, lmp, variables, folder, duration, words, progress):
    """Run the deck in its own folder with its output in ``folder``/dumps; raises CalibrationError where it fails."""
    parameter_file, changed = os.path.join(folder, "parameters"), os.path.join(folder, "deck")
    with open(parameter_file, "w", encoding="utf-8") as handle:
        handle.write(variables)
    with open(changed, "w", encoding="utf-8") as handle:
        handle.write(deck_text(deck, parameter_file, duration, words))
    dumps, log = os.path.join(folder, "dumps"), os.path.join(folder, "output")
    command = [*shlex.split(lmp), "-in", changed, "-log", os.path.join(folder, "log"), "-var", "out", dumps]
    try:
        with open(log, "w", encoding="utf-8") as output, subprocess.Popen(
                command, cwd=os.path.dirname(os.path.abspath(deck)), stdout=output, stderr=subprocess.STDOUT) as process:
            while _runs(process):
                written = len(os.listdir(dumps)) if os.path.isdir(dumps) else 0
                progress(f"lmp has written {written} snapshots", min(written * LAG_TAU / duration, 1.0))
    except OSError as error:
        raise CalibrationError(f"cannot run {lmp}: {error.strerror}") from error
    if process.returncode != 0:
        with open(log, encoding="utf-8", errors="replace") as output:
            raise CalibrationError(f"lmp failed on {deck}: {reason_of_failure(output.read())}")
    progress.finish(f"{duration:g} tau run")


def _runs(process, patience=1.0):
    """Whether the process still runs after ``patience`` seconds."""
    try:
        process.wait(patience)
        return False
    except subprocess.TimeoutExpired:
        return True
