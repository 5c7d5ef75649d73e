# SPDX-License-Identifier: GPL-2.0-or-later
"""Why a run of LAMMPS failed, from what it printed."""

import pytest
from spot_analysis.reading.log import reason_of_failure


@pytest.mark.parametrize("output, reason", [
    ("LAMMPS\nERROR: no fix spot (input.cpp:1)\nLast command: fix\nERROR: second\n", "ERROR: no fix spot (input.cpp:1)"),
    ("LAMMPS\nKilled\n\n", "Killed"), ("", "no output"), (" \n", "no output")])
def test_reason_of_failure(output, reason):
    assert reason_of_failure(output) == reason
