# SPDX-License-Identifier: GPL-2.0-or-later
"""A dry run of a deck of fix spot: numbers with what they should be, and a picture of walls, outlets, grains and spots."""

import argparse
import os
import re
import shlex
import subprocess
import tempfile

from ..base.errors import AnalysisError
from ..reading.json_object import read_object
from ..reading.log import reason_of_failure
from ..rendering.deck_picture import draw
from ..report.deck_numbers import numbers, table, tau_of
from . import command_line

SOURCES = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), *[os.pardir] * 3))
PROGRAMS = (os.path.join(SOURCES, "build", "bin", "lmp"), "/usr/libexec/spot-drainage/lmp", "/usr/local/libexec/spot-drainage/lmp")


def parse_arguments():
    parser = argparse.ArgumentParser(
        description="A dry run of a deck of fix spot, up to its first run: prints numbers with what they should be, and draws walls, outlets, "
        "grains and where spots go. The deck runs in its own folder; no dump is written, but print and shell commands do what they do.")
    parser.add_argument("deck", metavar="DECK")
    parser.add_argument("-o", "--output", default="check.png", metavar="FILE.png", help="(default: %(default)s)")
    parser.add_argument("--var", nargs=2, action="append", default=[], metavar=("NAME", "VALUE"), help="of the deck, as lmp -var; repeatable")
    parser.add_argument("--g", type=float, metavar="G", help="gravity's acceleration in the deck's units (default: 9.81 with 'units si', "
                        "981 with cgs, 1 with lj)")
    parser.add_argument("--lmp", default=next((path for path in PROGRAMS if os.path.exists(path)), "lmp"), metavar="COMMAND",
                        help="lmp with fix spot (default: %(default)s)")
    return parser.parse_args()


def dry_run(lmp, deck, variables):
    """What ``fix spot`` says of the deck, as of its JSON; raises AnalysisError with the error of LAMMPS or the fix."""
    if not os.path.isfile(deck):
        raise AnalysisError(f"{deck}: no such file")
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "dry_run.json")
        words = [word for name, value in [*variables, ("spot_dry_run", path)] for word in ("-var", name, value)]
        try:
            done = subprocess.run([*shlex.split(lmp), "-in", os.path.basename(deck), "-log", "none", *words], text=True, errors="replace",
                                  cwd=os.path.dirname(os.path.abspath(deck)), capture_output=True, stdin=subprocess.DEVNULL)
        except OSError as error:
            raise AnalysisError(f"cannot run {lmp}: {error.strerror}") from error
        said = done.stdout + done.stderr
        if done.returncode != 0:
            reason = reason_of_failure(said).removeprefix("ERROR: ").removeprefix("ERROR on proc 0: ")
            raise AnalysisError(f"{deck}: {re.sub(r' *[(][^() ]*[.]cpp:[0-9]+[)]$', '', reason)}")
        if not os.path.exists(path):
            raise AnalysisError(f"{deck}: ends without a run of a fix spot")
        found = read_object(path, "a dry run")
    found["warnings"] = re.findall(r"^WARNING: (fix spot.*?)(?: [(]\S+[)])?$", said, flags=re.MULTILINE)
    return found


def check_deck():
    options = parse_arguments()
    if not options.output.endswith(".png"):
        raise AnalysisError(f"--output {options.output}: must end in .png")
    run = dry_run(options.lmp, options.deck, options.var)
    tau = tau_of(run, options.g)
    rows = numbers(run, tau)
    print(table(rows))
    for warning in run["warnings"]:
        command_line.print_warning(warning)
    draw(run, options.output)
    print(f"{options.output}: walls, outlets, grains in two slices, and where spots go")


def main():
    command_line.run(check_deck)
