# SPDX-License-Identifier: GPL-2.0-or-later
"""Short runs of the examples against what was measured of DEM there, with wide bounds: a scene that is set up wrongly, or a model that
has broken, is far outside of them."""

import sys

from lammps_runs import ROOT

sys.path.insert(0, str(ROOT / "analysis"))

from spot_analysis.commands import summary  # noqa: E402  (only with the path above)
from spot_analysis.commands.quantities import read_stored  # noqa: E402


def assert_near_dem(run, reference, interval, bounds):
    """run : folder of dumps; reference : file of statistics, in examples; interval : of the run, tau, which DEM's need not be;
    bounds : quantity -> largest relative difference, of DEM's

    Bounds are the difference in the README of the example, of three seeds over DEM's interval, and 15 % on top for speeds, 5 % for
    outflows and packing fractions: a few tau of one seed scatter by 3 % in what leaves, and the flow higher up still sets in.
    """
    path = str(ROOT / "examples" / reference)
    dem, found = read_stored(path)["quantities"], summary.kind_of(path).measure(str(run), *interval)
    off = {name: found[name][0] / dem[name][0] - 1 for name in bounds}
    assert all(abs(off[name]) <= bounds[name] for name in bounds), {name: f"{off[name]:+.3f}" for name in bounds}
