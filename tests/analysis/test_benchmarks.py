# SPDX-License-Identifier: GPL-2.0-or-later
"""What the benchmarks take from the analysis: the stored DEM run that they hold the spot model against."""

import pathlib
import sys

import numpy as np
import pytest

BENCHMARKS = pathlib.Path(__file__).resolve().parents[2] / "benchmarks"


@pytest.fixture(scope="module")
def reference():
    sys.path.insert(0, str(BENCHMARKS))
    try:
        import measuring
    finally:
        sys.path.remove(str(BENCHMARKS))
    return measuring.Reference()


def test_the_reference_over_an_interval_of_many_snapshots(reference):
    view = reference.over((36.0, 54.0))
    assert view.interval.start == pytest.approx(36.0) and view.interval.end == pytest.approx(54.0)
    assert view.mean("1", reference.run.badness).value == pytest.approx(
        reference.run.badness[(reference.run.times > 35) & (reference.run.times < 55)].mean())


def test_the_reference_over_an_interval_between_snapshots(reference):
    view = reference.over((101.0, 104.0))
    assert (view.interval.start, view.interval.end) == pytest.approx((100.0, 110.0))


def test_the_packing_at_rest(reference):
    assert np.isfinite(reference.rest()).all() and reference.rest().max() > 3
