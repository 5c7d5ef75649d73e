# SPDX-License-Identifier: GPL-2.0-or-later
"""Looks up quantities by their names: what a statistic says of them, in its MEANING or NEEDS, and those of a curve."""

import re
from fnmatch import fnmatchcase


def by_name(table, name, default):
    """Of a table, pattern -> value, the value of the first pattern that fits the quantity ``name``."""
    return next((value for pattern, value in table.items() if fnmatchcase(name, pattern)), default)


def curve(found, pattern):
    """Places, values and their standard errors of the quantities, name -> [value, error], that fit a regular expression; its
    one group is the place in the name. In the order of places."""
    rows = [(float(match[1]), *value) for name, value in found.items() if (match := re.fullmatch(pattern, name))]
    return list(zip(*sorted(rows))) or [(), (), ()]
