# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures and animations of runs: what is drawn, its colours, the panels, the files."""
