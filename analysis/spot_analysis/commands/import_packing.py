# SPDX-License-Identifier: GPL-2.0-or-later
"""Make a data file and a deck of fix spot from a packing of LIGGGHTS, LAMMPS, YADE, or plain columns."""

import os

import numpy as np

from ..base.errors import AnalysisError
from ..base.progress import Progress
from ..importing import walls as shapes
from ..importing import writing
from ..importing.fitting import fit
from ..importing.outlet import doubts, require_inside
from ..importing.overlaps import relax
from ..importing.snapping import middle_of, near, snapped
from ..importing.turning import direction, turned
from ..reading.packing_file import read_packing
from . import command_line
from .import_options import UNITS, parse_arguments
from .import_sizes import EQUAL, NEARLY_EQUAL, diameters_of, mean_diameter

STICKS_OUT, THROUGH = 0.01, 0.3  # d beyond a wall: grains that are counted, and that are refused
GRAINS = (1e-5, 0.1)  # m that a grain's diameter is likely to be between
DENSITY = 2500.0  # kg/m3, glass


def placed(options, grains, diameters, scale):
    """Positions (n, 3) in the deck's unit, turned and shifted."""
    positions = turned(grains.positions * scale, direction(options.gravity)) + np.array(options.shift)
    if options.floor is not None:
        floor = (positions[:, 2] - diameters / 2).min() if options.floor == "auto" else options.floor
        positions = positions - [0, 0, floor]
        print(f"floor: z = {floor:.6g} is 0 now")
    return positions


def fitted(options, positions, diameters, height):
    """Walls, and their coverage, see ``fit``; height : of the outlet"""
    if np.ptp(diameters) > 0:
        nearly = bool(np.abs(diameters / diameters.mean() - 1).max() <= NEARLY_EQUAL)
        raise AnalysisError("--fit finds walls by the layer of equal grains at them: " + nearly * "give --equal-sizes, or "
                            + "name the walls by --box, --cylinder, --cone or --walls")
    return fit(options.fit, positions, mean_diameter(diameters), height)


def walls_of(options, positions, diameters):
    """Walls, or None where only their words are known, and (x, y, z, R) of the orifice."""
    height = options.orifice[2] if len(options.orifice) == 4 else 0.0
    diameter = mean_diameter(diameters)
    if options.walls:
        return None, tuple(options.orifice)
    if options.fit:
        found, coverage = fitted(options, positions, diameters, height)
    elif options.box:
        found = shapes.box(*options.box)
    elif options.cylinder:
        found = shapes.cylinder(*options.cylinder)
    else:
        x, y, low, radius, high = options.cone
        found = shapes.cone_and_cylinder(x, y, low, radius, height, height + high)
    middle = [near(value, 0.0, diameter) if options.fit else value for value in middle_of(found)]
    orifice = tuple(options.orifice) if len(options.orifice) == 4 else (*middle, 0.0, options.orifice[0])
    if options.fit:
        found = snapped(found, orifice, diameter)
        print("fit: " + "; ".join(f"{part}, {share:.2f} grains at it for each d^2"
                                  for part, (_, share) in zip(found.parts, coverage)))
    return shapes.around(found, orifice, diameter), orifice


def check_outlet(walls, orifice, positions, diameters):
    """Warn of what may be meant otherwise; raises AnalysisError where the outlet is outside of the walls."""
    diameter = mean_diameter(diameters)
    require_inside(walls, orifice, diameter)
    for doubt in doubts(walls, orifice, float((positions[:, 2] - diameters / 2).min()), diameter):
        command_line.print_warning(doubt)


def check_places(walls, positions, diameters):
    """Say how many grains stick out of the walls; raises AnalysisError where one is outside."""
    out = walls.sticking_out(positions, diameters)
    print(f"walls: {np.count_nonzero(out > STICKS_OUT)} of {len(out)} grains stick out by more than {STICKS_OUT} d, "
          f"the farthest by {max(out.max(), 0):.3f} d")
    if out.max() > THROUGH:
        grain, where = int(out.argmax()), " ".join(f"{value:.6g}" for value in positions[out.argmax()])
        raise AnalysisError(f"{np.count_nonzero(out > THROUGH)} grains stick out of the walls or the base by more than {THROUGH} d, such as grain "
                            f"{grain + 1} at {where} by {out.max():.2f} d: other walls, another --floor or --shift, or take these grains out")


def import_packing():
    options = parse_arguments()
    folder = writing.shared_files(options.lammps_files)
    grains = read_packing(options.packing, options.step, options.columns)
    scale = options.scale or UNITS[options.length_unit or "m"]
    diameters = diameters_of(options, grains, scale)
    diameter, unit = mean_diameter(diameters), "" if options.scale else " m"
    of_size = f"of {diameter:.6g}{unit}" if np.ptp(diameters) == 0 else f"of {diameter:.6g}{unit} by their mean volume"
    print(f"{options.packing}: {len(grains.positions)} grains {of_size}, {grains.where}")
    if not options.scale and not GRAINS[0] <= diameter <= GRAINS[1]:
        command_line.print_warning(f"grains of {diameter:g} m: is the file in another unit? (--length-unit mm)")
    if np.ptp(diameters) > EQUAL * diameter:
        command_line.print_warning("the deck's critical packing fraction is that of equal grains: "
                                   "a mixture flows denser (examples/bidisperse/README.md)")
    positions = placed(options, grains, diameters, scale)
    walls, orifice = walls_of(options, positions, diameters)
    if walls:
        check_outlet(walls, orifice, positions, diameters)
        check_places(walls, positions, diameters)
    relaxed = relax(positions, diameters, options.overlap, walls, Progress("import"))
    print(f"overlaps: the largest was {relaxed.before:.4f} d and is {relaxed.after:.4f} d, after {relaxed.sweeps} sweeps; no grain went "
          f"farther than {relaxed.moved:.4f} d")
    save(options, grains, relaxed.positions, diameters, walls, orifice, folder)


def save(options, grains, positions, diameters, walls, orifice, folder):
    os.makedirs(options.output, exist_ok=True)
    data, deck = (os.path.join(options.output, name) for name in ("packing.data", "in.spot"))
    writing.write_data(data, positions, diameters, options.density or grains.density or DENSITY, walls, orifice[2])
    with open(deck, "w", encoding="utf-8") as out:
        out.write(writing.deck(options.packing, "packing.data", positions, mean_diameter(diameters), walls, options.walls, orifice,
                               options.outflow, options.g or 9.81, options.run, folder, not options.scale))
    print(f"{data} and {deck} are written: lmp -in in.spot, in that folder\ntry: spot-check {deck}")


def main():
    command_line.run(import_packing)
