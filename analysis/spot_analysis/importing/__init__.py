# SPDX-License-Identifier: GPL-2.0-or-later
"""A packing of somebody's own made into a data file and a deck: turned, scaled, relaxed, with walls around it."""
