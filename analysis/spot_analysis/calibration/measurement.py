# SPDX-License-Identifier: GPL-2.0-or-later
"""What is read off one run for the calibration: the five numbers of section III of 2006, and what they need beside."""

from dataclasses import dataclass

import numpy as np

from ..statistics.counts import SLAB
from ..statistics.interval_view import IntervalView
from .correlation import Correlation, measure_correlation
from .diffusion import Diffusion, measure_diffusion
from .estimate import Estimate, combine
from .flow import measure_drop, measure_fraction, measure_outflow
from .front import Front, measure_front
from .spot_grains import spot_grains
from .spreading import Spreading, measure_spreading
from .view import view_of


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

    def relative_speed(self, dilation):
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

    start, end : tau, see ``view.choose_snapshots``; buffer : d
    """
    view = view_of(run, start, end)
    outflow, drop = measure_outflow(view), measure_drop(view)
    diffusion, correlation = measure_diffusion(view), measure_correlation(view, buffer)
    spreading = measure_spreading(view, correlation.radius.value, buffer)
    return Measured(view, outflow, drop, measure_front(run, float(outflow.value)), correlation, spreading, diffusion,
                    measure_fraction(view), buffer)
