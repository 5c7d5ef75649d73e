# SPDX-License-Identifier: GPL-2.0-or-later
"""The parameters of the spot model from the dumps of one run, by section III of 2006.

R_s from C(r), b_s from the widening v_z profile, w = b_p / b_s, v_s from the density drop, nu_s = F / (w <N>). What is
read off the grains is not quite what moves the spots: ``response`` says by how much, and is taken out.
"""

import numpy as np

from .estimate import CalibrationError, Estimate, combine
from .response import RADIUS, SLOPES

STEP_HEIGHT = 0.1  # d, dz of 2006: sets the move rate v_s / dz and the sideways step sqrt(4 b_s dz)
UNITS = {"radius": "d", "influence": "1", "volume": "grains", "diffusion": "d", "dilation": "1", "speed": "d/tau",
         "injection": "1/tau"}
SYMBOLS = {"radius": "R_s", "influence": "w", "volume": "<N>", "diffusion": "b_s", "dilation": "c_0", "speed": "v_s",
           "injection": "nu_s"}


def parameters(measured, response):
    """name -> Estimate of what gives what was ``measured``, with a response (of ``response``): the five parameters, the
    number of grains <N> in a spot, by which nu_s was found, and the dilation c_0 at which spots climb at v_s."""
    diffusion = combine(np.divide, measured.spreading.diffusion, response["diffusion"])
    radius = combine(lambda shown, added, slope: RADIUS + (shown - added - RADIUS) / slope, measured.correlation.radius,
                     response["radius"], response["radius_slope"])
    influence = combine(lambda b_p, added, slope, size, share, b_s: (b_p - added - slope * (size - RADIUS)) / (share * b_s),
                        measured.diffusion.length, response["particle_diffusion"], response["diffusion_slope"], radius,
                        response["share"], diffusion)
    speed = combine(lambda shown, ratio, relative: shown / (ratio * relative), measured.speed, response["speed"],
                    measured.relative_speed(response["dilation"]))
    for name, value in (("radius", radius), ("influence", influence), ("diffusion", diffusion), ("speed", speed)):
        if not value.is_determined(2.0):
            raise CalibrationError(f"{SYMBOLS[name]} is not determined: {float(value.value):.3g} +- {float(value.error):.2g} "
                                   f"{UNITS[name]} (C(r) shows {float(measured.correlation.radius.value):.2f} d; of b_p = "
                                   f"{float(measured.diffusion.length.value):.2g} d relaxation alone makes "
                                   f"{float(response['particle_diffusion'].value):.2g} d); choose a longer interval or "
                                   "another --response")
    grains = measured.grains_in(radius)
    injection = combine(lambda outflow, w, count: outflow / (w * count), measured.outflow, influence, grains)
    return {"radius": radius, "influence": influence, "volume": grains, "diffusion": diffusion,
            "dilation": response["dilation"], "speed": speed, "injection": injection}


def response_of(measured, put_in, slopes):
    """What a spot run shows against what was put into it: a response, name -> Estimate.

    put_in : name -> number, the run's parameters
    slopes : a response, whose SLOPES are kept: one run alone cannot tell them
    """
    radius = Estimate(np.array(put_in["radius"]), np.full_like(measured.outflow.replicates, put_in["radius"]))
    return {
        "radius": combine(lambda shown, size, slope: shown - RADIUS - slope * (size - RADIUS), measured.correlation.radius,
                          radius, slopes["radius_slope"]),
        "diffusion": combine(lambda value: value / put_in["diffusion"], measured.spreading.diffusion),
        "particle_diffusion": combine(
            lambda b_p, share, slope: b_p - share * put_in["influence"] * put_in["diffusion"] - slope * (put_in["radius"] - RADIUS),
            measured.diffusion.length, slopes["share"], slopes["diffusion_slope"]),
        **{name: slopes[name] for name in SLOPES},
        "speed": combine(lambda value, relative: value / (put_in["speed"] * relative), measured.speed, measured.relative_speed(slopes["dilation"])),
    }
