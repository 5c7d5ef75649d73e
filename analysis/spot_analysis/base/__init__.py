# SPDX-License-Identifier: GPL-2.0-or-later
"""What every room uses: errors, the interpreter's packages, lines on progress. Imports the standard library only."""
