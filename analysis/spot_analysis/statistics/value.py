# SPDX-License-Identifier: GPL-2.0-or-later
"""A measured number with its unit and standard error."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Value:
    """A number with its unit and standard error; None where it cannot be known."""

    unit: str
    value: float = None
    error: float = None

    @classmethod
    def of(cls, unit, value, error=None):
        """The Value of a measured number, which is unknown if it is not finite."""
        if not math.isfinite(value):
            return cls(unit)
        return cls(unit, float(value), float(error) if error is not None and math.isfinite(error) else None)
