# SPDX-License-Identifier: GPL-2.0-or-later
"""The result of a calibration as a table, as JSON, and as a file that examples/silo/in.silo_spot includes."""

import json
import math

import numpy as np

from ..calibration.estimate import combine
from ..calibration.parameters import STEP_HEIGHT, SYMBOLS, UNITS
from ..statistics.counts import SLAB
from ..statistics.particle_diffusion import DROPS

IN_THE_DECK = {"radius": "*v_d", "influence": "", "volume": "", "diffusion": "*v_d", "dilation": "", "speed": "*v_d/v_tau",
               "injection": "/v_tau"}


def described(estimate, unit):
    """An Estimate of a single number as JSON takes it; None where it is not known."""
    value, error = float(estimate.value), float(estimate.error)
    return {"value": value if math.isfinite(value) else None, "error": error if math.isfinite(error) else None,
            "unit": unit}


def _numbers_of(estimate, scale=1.0):
    """Value and error as floats; a number that was chosen, not measured, has the error 0, rounding apart."""
    value, error = scale * float(estimate.value), scale * float(estimate.error)
    return value, error if error > 1e-12 * abs(value) else 0.0


def table(parameters, uncorrected):
    """Lines of text: the parameters with errors, and what 2006's formulas give."""
    lines = [f"{'':10} {'value':>10} {'+-':>9}   {'as 2006':>10} {'+-':>9}   unit"]
    for name, unit in UNITS.items():
        (one, error), (other, other_error) = _numbers_of(parameters[name]), _numbers_of(uncorrected[name])
        lines.append(f"{SYMBOLS[name]:10} {one:10.4g} {error:9.2g}   {other:10.4g} {other_error:9.2g}   {unit}")
    return "\n".join(lines)


# R_s of spots with a profile over that of uniform ones with the same volume: the mean share is 1 or 0.4 (spot::SpotParameters).
RADII = {"uniform": 1.0, "parabolic": 0.4**(-1 / 3)}


def lammps_variables(parameters, source, span, profile="parabolic"):
    """Text that gives the deck's variables the values of ``parameters``, in the deck's units through v_d and v_tau.

    parameters : as ``calibration.parameters`` gives them, with R_s of uniform spots
    profile : of the spots to be run, a key of RADII

    To be included between these and the deck's own ``variable ... index``, which then leave alone what is set already.
    """
    lines = [f"# Calibrated by analysis/calibrate.py on {source}, {span[0]:g}-{span[1]:g} tau",
             "# lmp -in in.silo_spot -var parameters THIS_FILE",
             f"variable        profile    index {profile}"]
    for name, factor in IN_THE_DECK.items():
        value, error = _numbers_of(parameters[name], RADII[profile] if name == "radius" else 1.0)
        number = f"$({value:.6g}{factor})" if factor else f"{value:.6g}"
        lines.append(f"variable        {name:10} index {number}"
                     f"  # {SYMBOLS[name]}, +- {error:.2g} {UNITS[name]}")
    flux = combine(lambda w, grains, rate: w * grains * rate, *(parameters[name] for name in ("influence", "volume",
                                                                                              "injection")))
    if profile != "uniform":
        lines.append(f"# R_s is that of {profile} spots with the volume of uniform ones of R_s = {float(parameters['radius'].value):.4g} d.")
    lines.append(f"# Errors of w, <N> and nu_s go together: nu_s w <N> = {float(flux.value):.4g} +- "
                 f"{float(flux.error):.2g} /tau. Change all or none.")
    return "\n".join(lines) + "\n"


def as_json(measured, parameters, uncorrected, response, source):
    """Everything that was measured and fitted, as text."""
    spreading, correlation, diffusion = measured.spreading, measured.correlation, measured.diffusion
    speed, b_s = (float(parameters[name].value) for name in ("speed", "diffusion"))
    content = {
        "source": source,
        "interval": {"from": measured.view.interval.start, "to": measured.view.interval.end, "unit": "tau",
                     "snapshots": len(measured.view.snapshots)},
        "parameters": {name: described(parameters[name], unit) for name, unit in UNITS.items()},
        "uncorrected": {name: described(uncorrected[name], unit) for name, unit in UNITS.items()},
        "response": {name: described(value, "d" if name in ("radius", "particle_diffusion") else "1")
                     for name, value in response.items()},
        "step": {"dz": STEP_HEIGHT, "dx": math.sqrt(4 * b_s * STEP_HEIGHT), "moves": speed / STEP_HEIGHT,
                 "unit": "d, d, 1/tau"},
        "measured": {
            "outflow": described(measured.outflow, "1/tau"),
            f"grains_missing_{SLAB[0]}d_{SLAB[1]}d": described(measured.drop, "grains"),
            "front_speed": _front(measured.front),
            "correlation_decay": described(correlation.decay[1], "d"),
            "correlation_radius": described(correlation.radius, "d"),
            "correlation_amplitude": described(correlation.amplitude, "1"),
            "correlation_background": described(correlation.background, "1"),
            "particle_diffusion": described(diffusion.length, "d"),
            "grains_in_spot": described(measured.grains_in(parameters["radius"]), "grains"),
            "packing_fraction": described(measured.fraction, "1"),
        },
        "curves": {
            "correlation": _curve(correlation.distance, correlation.curve),
            "variance_of_profile": _curve(spreading.heights, spreading.variance),
            "sideways_variance": _curve(DROPS, diffusion.variance),
        },
    }
    return json.dumps(content, indent=1) + "\n"


def _front(front):
    return {"value": front.speed if front else None, "error": front.error if front else None, "unit": "d/tau"}


def _curve(places, estimate):
    return {"at": _numbers(places), "value": _numbers(estimate.value), "error": _numbers(estimate.error)}


def _numbers(values):
    return [float(f"{value:.6g}") if np.isfinite(value) else None for value in values]
