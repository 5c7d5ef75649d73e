# SPDX-License-Identifier: GPL-2.0-or-later
"""What is measured on packings and flows, with standard errors, and the file that stores it."""
