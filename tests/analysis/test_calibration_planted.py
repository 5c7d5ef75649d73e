# SPDX-License-Identifier: GPL-2.0-or-later
"""Planted parameters: calibrate.py must find again what went into a run of fix spot. Needs lmp; some minutes."""

import os

import numpy as np
import pytest
from spot_analysis.base.progress import Progress
from spot_analysis.calibration.estimate import Estimate
from spot_analysis.calibration.lammps_variables import lammps_variables
from spot_analysis.calibration.measurement import measure
from spot_analysis.calibration.parameters import parameters
from spot_analysis.calibration.refinement import run_deck
from spot_analysis.calibration.response import stored_response
from spot_analysis.calibration.view import CONCEPTS
from spot_analysis.reading.scene import load_scene
from spot_analysis.report import calibration_output
from spot_analysis.statistics.bootstrap import RESAMPLES
from spot_analysis.statistics.measuring import measure_dumps

from conftest import ANALYSIS

ROOT = ANALYSIS.parent
LMP = os.environ.get("SPOT_LMP", str(ROOT / "build" / "bin" / "lmp"))
PLANTED = {"radius": 2.4, "influence": 2.2e-3, "volume": 61.5, "diffusion": 1.15, "dilation": 0.03, "speed": 2.6, "injection": 540.0}
DURATION = 88.0  # tau


@pytest.mark.skipif(not os.access(LMP, os.X_OK), reason=f"no {LMP}")
def test_planted_parameters_lie_within_their_error_bars(tmp_path):
    """Three standard errors for each of five; the values of the stored response come from other runs."""
    planted = {name: Estimate(np.array(value), np.full(RESAMPLES, value)) for name, value in PLANTED.items()}
    variables = lammps_variables(planted, "nothing", (0, 0))
    run_deck(str(ROOT / "examples" / "silo" / "in.silo_spot"), LMP, variables, str(tmp_path), DURATION,
                                    "", Progress("planted"))
    dumps = str(tmp_path / "dumps")
    measured = measure(measure_dumps(dumps, load_scene(dumps), concepts=CONCEPTS))
    found = parameters(measured, stored_response("windowed"))
    print(calibration_output.table(found, planted))
    for name, value in PLANTED.items():
        assert found[name].value == pytest.approx(value, abs=3 * found[name].error), name
