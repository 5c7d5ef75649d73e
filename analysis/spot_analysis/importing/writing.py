# SPDX-License-Identifier: GPL-2.0-or-later
"""The data file and the deck of an imported packing."""

import os

import numpy as np

from ..base.errors import AnalysisError
from ..base.version import version
from .walls import fix_words, number, words

ROOM_BELOW, ROOM_ABOVE, ROOM_BESIDE = 10, 5, 1  # d, of the simulation box beyond outlet, grains and walls
ROOM_FOR_WALLS = 10  # d beside grains, where nobody has said how far away walls are
HEAD = """# Made by spot-import {version} from {source}: {walls}.
variable  d equal {diameter}              # grain diameter{unit}
variable  g equal {gravity}
variable  tau equal sqrt(v_d/v_g)
{outflow}units     {units}
atom_style sphere
boundary  f f f
include   {folder}/load_spot.lmp
include   {folder}/glass-beads.lmp   # sets beads: all of the spot model's numbers
read_data {data}
fix       drain all spot {fix} &
          orifice {orifice} &
          {rate} ${{beads}} scene scene.json ${{g}}
timestep  $(0.5*v_tau)
thermo_style custom step atoms f_drain[1] f_drain[5] f_drain[6]   # spots, outflow, largest overlap
thermo    20
dump      grains all custom 4 drain.*.dump id x y z radius vx vy vz
run       {steps}
"""


def shared_files(folder=None):
    """The folder of load_spot.lmp and glass-beads.lmp; raises AnalysisError where there is none."""
    here = os.path.dirname(os.path.abspath(__file__))
    source_tree = os.path.normpath(os.path.join(here, *[os.pardir] * 3, "lammps-package"))
    places = [folder] if folder else [source_tree, "/usr/share/spot-drainage", "/usr/local/share/spot-drainage"]
    for place in places:
        if all(os.path.isfile(os.path.join(place, name)) for name in ("load_spot.lmp", "glass-beads.lmp")):
            return os.path.abspath(place)
    raise AnalysisError(f"no load_spot.lmp and glass-beads.lmp in {' or '.join(places)}: --lammps-files names the folder "
                        "lammps-package of the sources, or share/spot-drainage where it is installed")


def top_of(positions, diameter):
    """A height above all grains: of the simulation box and the upper end of walls."""
    return float(np.ceil(positions[:, 2].max() / diameter + ROOM_ABOVE) * diameter)


def write_data(path, positions, diameters, density, walls, outlet):
    """A data file of ``atom_style sphere``, with ids in the order of the positions (n, 3).

    diameters : (n,); walls : Walls, or None where only their words are known; outlet : its height
    """
    diameter = diameters.max()
    room = diameter * (ROOM_BESIDE if walls else ROOM_FOR_WALLS)
    low, high = positions.min(axis=0) - room, positions.max(axis=0) + room
    low[2], high[2] = min(low[2], outlet - ROOM_BELOW * diameter), top_of(positions, diameter)
    for axis, (start, end) in enumerate(extent(walls)):
        low[axis] = min(low[axis], start - ROOM_BESIDE * diameter)
        high[axis] = max(high[axis], end + ROOM_BESIDE * diameter)
    with open(path, "w", encoding="ascii") as out:
        out.write(f"packing made by spot-import\n\n{len(positions)} atoms\n1 atom types\n\n")
        out.writelines(f"{words(low[axis], high[axis])} {name}lo {name}hi\n" for axis, name in enumerate("xyz"))
        out.write("\nAtoms # sphere\n\n")
        out.writelines(f"{index} 1 {words(size, density, *position)}\n" for index, (size, position) in enumerate(zip(diameters, positions), 1))


def extent(walls):
    """Lower and upper end of the walls along x and y."""
    if walls is None:
        return []
    if walls.axis is None:
        return [walls.numbers[:2], walls.numbers[2:]]
    radius = walls.numbers[2 if walls.name == "cylinder" else 3]
    return [(centre - radius, centre + radius) for centre in walls.axis]


def deck(source, data, positions, diameter, walls, wall_words, orifice, outflow, gravity, steps, folder, si):
    """The text of a deck.

    walls : Walls, or None; then wall_words are those of the fix
    orifice : (x, y, z, R); outflow : grains in a time, or None for Beverloo's law; si : whether lengths are in m
    """
    rate, measured = "beverloo ${g}", ""
    if outflow:
        time = "second" if si else "unit of time"
        rate, measured = "outflow ${F}", f"variable  F equal {number(outflow)}              # grains that leave in a {time}\n"
    return HEAD.format(version=version(), source=os.path.basename(source), walls=walls.name if walls else "walls as given", diameter=number(diameter),
                       unit=", m" if si else "", gravity=number(gravity), outflow=measured, units="si" if si else "lj", folder=folder,
                       data=data, fix=wall_words or fix_words(walls, top_of(positions, diameter)), orifice=words(*orifice), rate=rate,
                       steps=steps)
