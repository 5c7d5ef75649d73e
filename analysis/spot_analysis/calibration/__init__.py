# SPDX-License-Identifier: GPL-2.0-or-later
"""Fits of the spot model's parameters to what was measured, with replicates for their errors."""
