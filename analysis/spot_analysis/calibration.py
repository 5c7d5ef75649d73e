# SPDX-License-Identifier: GPL-2.0-or-later
"""The parameters of the spot model from the dumps of one run, by section III of 2006.

R_s from C(r), b_s from the widening v_z profile, w = b_p / b_s, v_s from the density drop, nu_s = F / (w <N>). What is
read off the grains is not quite what moves the spots: ``calibration_response`` says by how much, and is taken out.
"""

from dataclasses import dataclass

import numpy as np

from .calibration_correlation import Correlation, measure_correlation
from .calibration_diffusion import Diffusion, measure_diffusion
from .calibration_estimate import CalibrationError, Estimate, combine
from .calibration_flow import measure_drop, measure_outflow
from .calibration_front import Front, measure_front
from .calibration_mean_flow import take_out_mean_flow
from .calibration_spot_grains import cut_share, grains_within, measure_spot_grains
from .calibration_spreading import Spreading, measure_spreading
from .calibration_tracks import Core, Tracks, find_core, read_tracks
from .counts import SLAB
from .progress import Progress

STEP_HEIGHT = 0.1  # d, dz of 2006: sets the move rate v_s / dz and the sideways step sqrt(4 b_s dz)
UNITS = {"radius": "d", "influence": "1", "volume": "grains", "diffusion": "d", "speed": "d/tau", "injection": "1/tau"}
SYMBOLS = {"radius": "R_s", "influence": "w", "volume": "<N>", "diffusion": "b_s", "speed": "v_s", "injection": "nu_s"}


@dataclass(frozen=True)
class Measured:
    """All that was read off one run; Estimates in d and tau.

    outflow : F; drop : grains missing between the heights of SLAB; front : Front, None without early snapshots
    grain_table : mean number of grains in spheres of SPOT_RADII
    buffer : distance that spot centres keep from the walls
    """

    tracks: Tracks
    core: Core
    outflow: Estimate
    drop: Estimate
    front: Front
    correlation: Correlation
    spreading: Spreading
    diffusion: Diffusion
    grain_table: Estimate
    buffer: float

    @property
    def speed(self):
        """v_s: while nu_s w <N> = F grains a tau are missing for the time that spots need through the slab, Delta N = F
        Delta z / v_s."""
        return combine(lambda outflow, drop: outflow * (SLAB[1] - SLAB[0]) / drop, self.outflow, self.drop)

    def grains_in(self, radius):
        """<N> in a spot of the Estimate ``radius``."""
        return grains_within(self.grain_table, radius)

    def grains_formula(self, radius):
        """<N> from the mean packing fraction of the core's heights and the sphere that walls cut (2006: uncut)."""
        container = self.tracks.container
        heights = self.tracks.positions[..., 2]
        with np.errstate(invalid="ignore"):
            count = ((heights > self.core.bottom) & (heights < self.core.top)).sum(axis=1).mean()
        volume = 4 * container.half_width * container.half_depth * (self.core.top - self.core.bottom)
        return float(count / volume * 4 / 3 * np.pi * radius**3 * cut_share(container, radius, self.buffer))


def measure(source, scene, start=None, end=None, buffer=1.0, method="walled_moment", warn=print):
    """Measured from the dumps ``source``; raises DumpError, SceneError, CalibrationError.

    start, end : tau, see ``read_tracks``; buffer : d; method : one of ``calibration_spreading.METHODS``
    """
    tracks = read_tracks(source, scene, start, end, warn)
    progress = Progress("calibrating")
    outflow, drop, core = measure_outflow(tracks), measure_drop(tracks), find_core(tracks)
    fluctuations = take_out_mean_flow(tracks, core)
    diffusion = measure_diffusion(tracks, fluctuations, core)
    correlation = measure_correlation(tracks, fluctuations, core, buffer, progress)
    progress("v_z profiles")
    spreading = measure_spreading(tracks, correlation.radius.value, buffer, core.top, method)
    progress("grains in a spot")
    table = measure_spot_grains(tracks, spreading.lines[method].value, buffer)
    front = measure_front(tracks, float(outflow.value))
    progress.finish("all fits done")
    return Measured(tracks, core, outflow, drop, front, correlation, spreading, diffusion, table, buffer)


def parameters(measured, response):
    """name -> Estimate of what gives what was ``measured``, with a ``calibration_response``: the five parameters, and the
    number of grains <N> in a spot, by which nu_s was found."""
    diffusion = combine(np.divide, measured.spreading.diffusion, response["diffusion"])
    radius = combine(np.subtract, measured.correlation.radius, response["radius"])
    influence = combine(lambda b_p, added, share, b_s: (b_p - added) / (share * b_s), measured.diffusion.length,
                        response["particle_diffusion"], response["share"], diffusion)
    speed = combine(np.divide, measured.speed, response["speed"])
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
    return {"radius": radius, "influence": influence, "volume": grains, "diffusion": diffusion, "speed": speed,
            "injection": injection}


def response_of(measured, put_in, share):
    """What a spot run shows against what was put into it: a ``calibration_response``, name -> Estimate.

    put_in : name -> number, the run's parameters; without "volume" what its spots hold counts
    share : Estimate, see there
    """
    radius = Estimate(np.array(put_in["radius"]), np.full_like(measured.outflow.replicates, put_in["radius"]))
    count = put_in.get("volume", measured.grains_in(radius).value)
    return {
        "radius": combine(np.subtract, measured.correlation.radius, radius),
        "diffusion": combine(lambda value: value / put_in["diffusion"], measured.spreading.diffusion),
        "particle_diffusion": combine(lambda b_p, part: b_p - part * put_in["influence"] * put_in["diffusion"],
                                      measured.diffusion.length, share),
        "share": share,
        "speed": combine(lambda value: value / put_in["speed"], measured.speed),
        "outflow": combine(lambda outflow: outflow / (put_in["injection"] * put_in["influence"] * count),
                           measured.outflow),
    }
