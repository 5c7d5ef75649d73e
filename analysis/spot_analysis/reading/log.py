# SPDX-License-Identifier: GPL-2.0-or-later
"""What LAMMPS prints."""


def reason_of_failure(output):
    """One line of the output of a run that failed: its first error, or what it ends with."""
    lines = output.strip().splitlines() or ["no output"]
    return next((line for line in lines if line.startswith("ERROR")), lines[-1])
