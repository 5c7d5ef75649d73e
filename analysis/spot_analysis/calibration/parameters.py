# SPDX-License-Identifier: GPL-2.0-or-later
"""The parameters of the spot model from the dumps of one run, by section III of 2006.

R_s from C(r), b_s from the widening v_z profile, w = b_p / b_s, v_s from the density drop, nu_s = F / (w <N>). What is
read off the grains is not quite what moves the spots: ``calibration_response`` says by how much, and is taken out.
"""

from dataclasses import dataclass

import numpy as np

from ..statistics.counts import SLAB
from ..statistics.interval import IntervalView
from .correlation import Correlation, measure_correlation
from .diffusion import Diffusion, measure_diffusion
from .estimate import CalibrationError, Estimate, combine
from .flow import measure_drop, measure_fraction, measure_outflow
from .front import Front, measure_front
from .response import RADIUS, SLOPES
from .spot_grains import spot_grains
from .spreading import Spreading, measure_spreading
from .view import view_of

STEP_HEIGHT = 0.1  # d, dz of 2006: sets the move rate v_s / dz and the sideways step sqrt(4 b_s dz)
UNITS = {"radius": "d", "influence": "1", "volume": "grains", "diffusion": "d", "dilation": "1", "speed": "d/tau",
         "injection": "1/tau"}
SYMBOLS = {"radius": "R_s", "influence": "w", "volume": "<N>", "diffusion": "b_s", "dilation": "c_0", "speed": "v_s",
           "injection": "nu_s"}


@dataclass(frozen=True)
class Measured:
    """All that was read off one run; Estimates in d and tau.

    view : of the snapshots that the run is calibrated on
    outflow : F; drop : grains missing between the heights of SLAB; front : Front, None without early snapshots
    fraction : packing fraction in flow
    buffer : distance that spot centres keep from the walls
    """

    view: IntervalView
    outflow: Estimate
    drop: Estimate
    front: Front
    correlation: Correlation
    spreading: Spreading
    diffusion: Diffusion
    fraction: Estimate
    buffer: float

    @property
    def speed(self):
        """Mean speed of spots: while nu_s w <N> = F grains a tau are missing for the time that spots need through the slab,
        Delta N = F Delta z / v_s."""
        return combine(lambda outflow, drop: outflow * (SLAB[1] - SLAB[0]) / drop, self.outflow, self.drop)

    def pace(self, dilation):
        """Their speed over v_s, if they climb at v_s (c / c_0)^2 where they take the share c of the volume (fix spot,
        ``dilation``): c is that of the grains missing in the slab. 1 for an Estimate c_0 = 0, spots that climb at v_s."""
        if dilation.value == 0:
            return combine(np.ones_like, self.drop)
        container = self.view.run.scene.container()
        volume = 4 * container.half_width * container.half_depth * (SLAB[1] - SLAB[0])
        return combine(lambda drop, c_0: (drop * np.pi / 6 / volume / c_0)**2, self.drop, dilation)

    def grains_in(self, radius):
        """<N> in a spot of the Estimate ``radius``."""
        container = self.view.run.scene.container()
        return combine(lambda fraction, size: spot_grains(fraction, size, container, self.buffer), self.fraction, radius)


def measure(run, start=None, end=None, buffer=0.25):
    """Measured from RunStatistics; raises CalibrationError.

    start, end : tau, see ``calibration_view.choose_snapshots``; buffer : d
    """
    view = view_of(run, start, end)
    outflow, drop = measure_outflow(view), measure_drop(view)
    diffusion, correlation = measure_diffusion(view), measure_correlation(view, buffer)
    spreading = measure_spreading(view, correlation.radius.value, buffer)
    return Measured(view, outflow, drop, measure_front(run, float(outflow.value)), correlation, spreading, diffusion,
                    measure_fraction(view), buffer)


def parameters(measured, response):
    """name -> Estimate of what gives what was ``measured``, with a ``calibration_response``: the five parameters, the
    number of grains <N> in a spot, by which nu_s was found, and the dilation c_0 at which spots climb at v_s."""
    diffusion = combine(np.divide, measured.spreading.diffusion, response["diffusion"])
    radius = combine(lambda shown, added, slope: RADIUS + (shown - added - RADIUS) / slope, measured.correlation.radius,
                     response["radius"], response["radius_slope"])
    influence = combine(lambda b_p, added, slope, size, share, b_s: (b_p - added - slope * (size - RADIUS)) / (share * b_s),
                        measured.diffusion.length, response["particle_diffusion"], response["diffusion_slope"], radius,
                        response["share"], diffusion)
    speed = combine(lambda shown, ratio, pace: shown / (ratio * pace), measured.speed, response["speed"],
                    measured.pace(response["dilation"]))
    for name, value in (("radius", radius), ("influence", influence), ("diffusion", diffusion), ("speed", speed)):
        if not value.is_determined(2.0):
            raise CalibrationError(f"{SYMBOLS[name]} is not determined: {float(value.value):.3g} +- {float(value.error):.2g} "
                                   f"{UNITS[name]} (C(r) shows {float(measured.correlation.radius.value):.2f} d; of b_p = "
                                   f"{float(measured.diffusion.length.value):.2g} d relaxation alone makes "
                                   f"{float(response['particle_diffusion'].value):.2g} d); choose a longer interval or "
                                   "another --response")
    grains = measured.grains_in(radius)
    injection = combine(lambda outflow, kept, w, count: outflow / (kept * w * count), measured.outflow, response["outflow"],
                        influence, grains)
    return {"radius": radius, "influence": influence, "volume": grains, "diffusion": diffusion,
            "dilation": response["dilation"], "speed": speed, "injection": injection}


def response_of(measured, put_in, slopes):
    """What a spot run shows against what was put into it: a ``calibration_response``, name -> Estimate.

    put_in : name -> number, the run's parameters; without "volume" what its spots hold counts
    slopes : a response, whose SLOPES are kept: one run alone cannot tell them
    """
    radius = Estimate(np.array(put_in["radius"]), np.full_like(measured.outflow.replicates, put_in["radius"]))
    count = put_in.get("volume", measured.grains_in(radius).value)
    return {
        "radius": combine(lambda shown, size, slope: shown - RADIUS - slope * (size - RADIUS), measured.correlation.radius,
                          radius, slopes["radius_slope"]),
        "diffusion": combine(lambda value: value / put_in["diffusion"], measured.spreading.diffusion),
        "particle_diffusion": combine(
            lambda b_p, share, slope: b_p - share * put_in["influence"] * put_in["diffusion"] - slope * (put_in["radius"] - RADIUS),
            measured.diffusion.length, slopes["share"], slopes["diffusion_slope"]),
        **{name: slopes[name] for name in SLOPES},
        "speed": combine(lambda value, pace: value / (put_in["speed"] * pace), measured.speed, measured.pace(slopes["dilation"])),
        "outflow": combine(lambda outflow: outflow / (put_in["injection"] * put_in["influence"] * count),
                           measured.outflow),
    }
