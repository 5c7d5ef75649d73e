# SPDX-License-Identifier: GPL-2.0-or-later
"""What is read: dumps and the scene beside them, that is units, walls and orifice."""
