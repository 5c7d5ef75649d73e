# SPDX-License-Identifier: GPL-2.0-or-later
"""The commands of the installed package: each module has a main() that bad input ends with one line and exit status 1."""
