# SPDX-License-Identifier: GPL-2.0-or-later
"""The stored DEM statistics against numbers taken from the same dumps by an independent script."""

import pathlib

import numpy as np
import pytest
from spot_analysis.report import comparison
from spot_analysis.statistics import run_statistics
from spot_analysis.statistics.counts import FLUX_HEIGHTS
from spot_analysis.statistics.interval import choose_interval
from spot_analysis.statistics.interval_view import IntervalView

STORED = pathlib.Path(__file__).resolve().parents[2] / "examples" / "silo" / "reference" / "dem-statistics.npz"


@pytest.fixture(scope="module")
def dem():
    return run_statistics.load(STORED)


def quantities(dem, start, end):
    interval = choose_interval(dem.times, start, end)
    return comparison.quantities(IntervalView(dem, np.arange(len(dem.times)), interval))


WINDOWS = pytest.mark.parametrize("window, span", [(0, (40, 92)), (1, (250, 300))])
INDEPENDENT = {  # quoted without error
    "outflow": (69.3, 70.6), "slab_count": (8770, 8770), "packing_fraction": (0.574, 0.575),
    "profile_variance_10d": (25.7, 27.9), "profile_variance_30d": (74.9, 80.0), "profile_variance_50d": (113.9, 125.0),
}
ROUNDING = {"slab_count": 20, "packing_fraction": 0.0005}


@WINDOWS
def test_independent_numbers_lie_within_two_standard_errors(dem, window, span):
    measured = quantities(dem, *span)
    for name, values in INDEPENDENT.items():
        tolerance = max(2 * measured[name].error, ROUNDING.get(name, 0))
        assert measured[name].value == pytest.approx(values[window], abs=tolerance), name


@WINDOWS
def test_independent_numbers_are_met_exactly_where_the_samples_are_known(dem, window, span):
    """Outflow was the slope of a straight line, badness and overlap came from the snapshots at multiples of 8 tau."""
    inside = (dem.times >= span[0]) & (dem.times <= span[1])
    slope = np.polyfit(dem.times[inside], dem.count_above(0)[inside], 1)[0]
    assert round(-slope, 1) == (69.3, 70.6)[window]
    sampled = inside & (dem.times % 8 == 0)
    assert round(dem.badness[sampled].mean() * 1e5, 2) == (1.73, 1.64)[window]
    assert round(dem.region_largest_overlap[sampled].max(), 4) == (0.0093, 0.0086)[window]


def test_at_rest(dem):
    assert dem.count_above(50)[0] - dem.count_above(70)[0] == 9191
    assert dem.contacts[0] == pytest.approx(5.2, abs=0.05)
    assert dem.badness[0] == pytest.approx(7.8e-5, rel=0.01)
    assert dem.largest_overlap[0] == pytest.approx(0.0125, abs=5e-5)


def test_no_grain_is_ever_outside(dem):
    assert dem.outside.max() == 0
    assert dem.largest_wall_overlap.max() < 0.015


def test_fluxes_equal_the_outflow(dem):
    """Over 200-304 tau; within 2 % or two standard errors."""
    measured = quantities(dem, 200, 304)
    for height in FLUX_HEIGHTS:
        ratio = measured[f"flux_{height}d_over_outflow"]
        assert ratio.value == pytest.approx(1, abs=max(0.02, 2 * ratio.error))


def test_both_halves_of_the_steady_flow_agree(dem):
    """Within 4 standard errors of the difference, for what neither the falling surface nor the widening flow changes."""
    first, second = quantities(dem, 200, 252), quantities(dem, 252, 304)
    for name in ("outflow", "outflow_fano", "correlation_length", "correlation_amplitude", "particle_diffusion",
                 "contacts_per_grain", "badness", "rdf_first_minimum", "voronoi_fraction_spread", "speed_wall_over_middle",
                 "packing_fraction_middle", "packing_wall_over_middle", "profile_variance_10d", "gaussian_variance_20d"):
        error = np.hypot(first[name].error, second[name].error)
        assert first[name].value == pytest.approx(second[name].value, abs=4 * error), name


def test_structure_is_that_of_dense_random_flow(dem):
    """The paper's bond cut-off; the mean over grains of pi/6 over the cell's volume lies above the packing fraction by the
    relative variance of the volumes; few crystal-like grains."""
    measured = quantities(dem, 200, 304)
    assert measured["rdf_first_minimum"].value == pytest.approx(1.38, abs=0.015)
    excess = measured["voronoi_fraction"].value / measured["packing_fraction"].value - 1
    relative = measured["voronoi_fraction_spread"].value / measured["voronoi_fraction"].value
    assert excess == pytest.approx(relative**2, abs=0.003)
    assert 0.01 < measured["crystal_share"].value < 0.04


def test_width_of_the_flow_agrees_with_the_line_of_2006(dem):
    """Slope of the second moments over 40-92 tau: 2.28 in 2006 (there later, and in another packing)."""
    slope = quantities(dem, 40, 92)["profile_variance_slope"]
    assert slope.value == pytest.approx(2.28, abs=2 * slope.error)


def test_front_is_not_sought_above_the_surface(dem):
    assert quantities(dem, 200, 304)["arrival_90d"].value is None
    assert quantities(dem, 40, 92)["arrival_90d"].value == pytest.approx(24, abs=4)
