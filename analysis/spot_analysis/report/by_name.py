# SPDX-License-Identifier: GPL-2.0-or-later
"""Looks up what a statistic says of its quantities, in its MEANING or NEEDS."""

from fnmatch import fnmatchcase


def by_name(table, name, default):
    """Of a table, pattern -> value, the value of the first pattern that fits the quantity ``name``."""
    return next((value for pattern, value in table.items() if fnmatchcase(name, pattern)), default)
