# SPDX-License-Identifier: GPL-2.0-or-later
"""The result of a calibration as a table and as JSON."""

import json
import math

import numpy as np

from ..calibration.parameters import STEP_HEIGHT, SYMBOLS, UNITS
from ..statistics.counts import SLAB
from ..statistics.particle_diffusion import DROPS


def described(estimate, unit):
    """An Estimate of a single number as JSON takes it; None where it is not known."""
    value, error = float(estimate.value), float(estimate.error)
    return {"value": value if math.isfinite(value) else None, "error": error if math.isfinite(error) else None,
            "unit": unit}


def table(parameters, uncorrected):
    """Lines of text: the parameters with errors, and what 2006's formulas give."""
    lines = [f"{'':10} {'value':>10} {'+-':>9}   {'as 2006':>10} {'+-':>9}   unit"]
    for name, unit in UNITS.items():
        (one, error), (other, other_error) = parameters[name].as_floats(), uncorrected[name].as_floats()
        lines.append(f"{SYMBOLS[name]:10} {one:10.4g} {error:9.2g}   {other:10.4g} {other_error:9.2g}   {unit}")
    return "\n".join(lines)


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
