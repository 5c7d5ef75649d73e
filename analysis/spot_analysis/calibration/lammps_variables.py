# SPDX-License-Identifier: GPL-2.0-or-later
"""The parameters as LAMMPS variables: the file that examples/silo/in.silo_spot includes."""

from .estimate import combine
from .parameters import SYMBOLS, UNITS

IN_THE_DECK = {"radius": "*v_d", "influence": "", "volume": "", "diffusion": "*v_d", "dilation": "", "speed": "*v_d/v_tau"}
# Of the deck, and not of the runs by which response.py tells what is put in from what is shown: left out of the model.
OFF = ("critical", "dilatancy", "full_strain", "spread", "surface", "nonaffine", "closing_gap")


# R_s of spots with a profile over that of uniform ones with the same volume: the mean share is 1 or 0.4. A test holds
# this against spot::InfluenceProfile.
RADII = {"uniform": 1.0, "parabolic": 0.4**(-1 / 3)}


def lammps_variables(parameters, source, span, profile="parabolic"):
    """Text that gives the deck's variables the values of ``parameters``, in the deck's units through v_d and v_tau.

    parameters : as ``parameters.parameters`` gives them, with R_s of uniform spots
    profile : of the spots to be run, a key of RADII

    To be included between these and the deck's own ``variable ... index``, which then leave alone what is set already.
    """
    lines = [f"# Calibrated by analysis/calibrate.py on {source}, {span[0]:g}-{span[1]:g} tau",
             "# lmp -in in.silo_spot -var parameters THIS_FILE",
             f"variable        profile    index {profile}"]
    for name, factor in IN_THE_DECK.items():
        value, error = parameters[name].as_floats(RADII[profile] if name == "radius" else 1.0)
        number = f"$({value:.6g}{factor})" if factor else f"{value:.6g}"
        lines.append(f"variable        {name:10} index {number}"
                     f"  # {SYMBOLS[name]}, +- {error:.2g} {UNITS[name]}")
    flux = combine(lambda w, grains, rate: w * grains * rate, *(parameters[name] for name in ("influence", "volume",
                                                                                              "injection")))
    lines.append(f"variable        {'outflow':10} index {float(flux.value):.6g}  # F = nu_s w <N>, +- {float(flux.error):.2g} 1/tau")
    lines += ["# Off, as in the runs that calibration was tried on"] + [f"variable        {name:10} index 0" for name in OFF]
    if profile != "uniform":
        lines.append(f"# R_s is that of {profile} spots with the volume of uniform ones of R_s = {float(parameters['radius'].value):.4g} d.")
    return "\n".join(lines) + "\n"
