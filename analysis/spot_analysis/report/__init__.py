# SPDX-License-Identifier: GPL-2.0-or-later
"""What people get to see: the comparison of two runs, the result of a calibration; tables, pictures, JSON, HTML."""
