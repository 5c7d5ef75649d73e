# SPDX-License-Identifier: GPL-2.0-or-later
"""The command line of import_packing.py, and its checks."""

import argparse
import math
import sys

from ..base.errors import AnalysisError

UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "in": 0.0254}  # m
DESCRIPTION = "Make a data file and a deck of fix spot from a packing of LIGGGHTS, LAMMPS, YADE, or plain columns."


class _Parser(argparse.ArgumentParser):
    """Its errors are one line, too."""

    def error(self, message):
        raise AnalysisError(message)


def parse_arguments():
    parser = _Parser(
        description=DESCRIPTION, epilog="All lengths of the options for walls, outlet and shift are in the deck's unit, in m with "
        "--length-unit, and count after the turn.")
    add = parser.add_argument
    add("packing", metavar="FILE", help="dump or data file of LIGGGHTS or LAMMPS, yade.export.text, or columns x y z r; also gzip, zstd")
    add("-o", "--output", default=".", metavar="FOLDER", help="gets packing.data and in.spot (default: this one)")
    add("--step", type=int, metavar="N", help="timestep of the dump (default: the last)")
    add("--columns", nargs="+", metavar="NAME", help="of plain columns: x y z, and r or d")
    unit = parser.add_mutually_exclusive_group()
    unit.add_argument("--length-unit", choices=UNITS, help="of the file; the deck is in m (default: m)")
    unit.add_argument("--scale", type=_positive, metavar="X", help="multiply all lengths; the deck's unit is yours, see --g")
    add("--g", type=_positive, metavar="G", help="gravity's acceleration (default: 9.81, in m/s2; with --scale it has to be given)")
    add("--gravity", nargs="+", default=["-z"], metavar="AXIS", help="its direction in the file, such as -y or 0 -1 0.2; the packing is "
        "turned so that it is -z (default)")
    add("--shift", nargs=3, type=_number, metavar=("X", "Y", "Z"), default=(0.0, 0.0, 0.0), help="move the packing, after the turn")
    add("--floor", metavar="Z", help="move the packing so that this height, of the outlet, is 0; auto: the lowest grain's lower end")
    add("--diameter", type=_positive, metavar="D", help="of all grains, in the deck's unit (default: that in the file)")
    add("--density", type=_positive, metavar="RHO", help="(default: that in the file, else 2500)")
    add("--equal-sizes", action="store_true", help="give all grains the mean diameter, where theirs are within 1 %% of it, which drains faster")
    add("--overlap", type=_positive, default=0.02, metavar="D", help="push grains apart that overlap by more (default: %(default)s d)")
    walls = parser.add_mutually_exclusive_group(required=True)
    walls.add_argument("--fit", choices=("box", "cylinder", "cone-and-cylinder"), help="find the walls that the packing lies in")
    walls.add_argument("--box", nargs=4, type=_number, metavar=("XLO", "XHI", "YLO", "YHI"))
    walls.add_argument("--cylinder", nargs=3, type=_number, metavar=("X", "Y", "R"), help="upright")
    walls.add_argument("--cone", nargs=5, type=_number, metavar=("X", "Y", "RLO", "R", "HEIGHT"),
                       help="from radius RLO at the outlet to an upright cylinder of radius R, so HEIGHT above")
    walls.add_argument("--walls", metavar="WORDS", help="of fix spot, as they are, such as 'walls add sphere 0 0 1 1'")
    add("--orifice", nargs="+", type=_number, required=True, metavar="X", help="x y z R, or R alone: in the middle of the walls, at z = 0")
    rate = parser.add_mutually_exclusive_group()
    rate.add_argument("--outflow", type=_positive, metavar="F", help="grains that leave in a second, measured")
    rate.add_argument("--beverloo", action="store_true", help="take the outflow from Beverloo's law (default)")
    add("--run", type=int, default=160, metavar="N", help="steps of tau/2 (default: %(default)s)")
    add("--lammps-files", metavar="FOLDER", help="of load_spot.lmp and glass-beads.lmp, where these are not found")
    return _checked(parser.parse_args(_joined(sys.argv[1:])))


def _joined(words):
    """argparse takes the -y of '--gravity -y' for an option."""
    joined = []
    for word in words:
        if joined[-1:] == ["--gravity"] and word[:1] == "-" and word[1:] in ("x", "y", "z"):
            joined[-1] = f"--gravity={word}"
        else:
            joined.append(word)
    return joined


def _checked(options):
    if len(options.orifice) not in (1, 4) or options.orifice[-1] <= 0:
        raise AnalysisError("--orifice: x y z R, or R alone, which must be positive")
    if len(options.orifice) == 1 and options.walls:
        raise AnalysisError("--orifice: give x y z R where the walls are given by --walls")
    if options.floor not in (None, "auto"):
        try:
            options.floor = _number(options.floor)
        except argparse.ArgumentTypeError:
            raise AnalysisError(f"--floor {options.floor}: a height, or auto") from None
    if options.scale and not options.g:
        raise AnalysisError("--scale: give --g, too, gravity's acceleration in the unit that you scale to")
    for name, numbers, fine in (("box", options.box, lambda n: n[0] < n[1] and n[2] < n[3]), ("cylinder", options.cylinder, lambda n: n[2] > 0),
                                ("cone", options.cone, lambda n: 0 < n[2] < n[3] and n[4] > 0)):
        if numbers and not fine(numbers):
            raise AnalysisError(f"--{name} {' '.join(f'{number:g}' for number in numbers)}: these must be in increasing order, and positive "
                                "where they are radii")
    if options.overlap >= 0.03:
        raise AnalysisError(f"--overlap {options.overlap:g}: must be below 0.03 d, which fix spot refuses at the start")
    if options.run < 1:
        raise AnalysisError(f"--run {options.run}: must be 1 or more")
    return options


def _number(text):
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"'{text}' must be a finite number")
    return value


def _positive(text):
    value = _number(text)
    if value <= 0:
        raise argparse.ArgumentTypeError(f"'{text}' must be a positive number")
    return value
