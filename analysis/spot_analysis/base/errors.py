# SPDX-License-Identifier: GPL-2.0-or-later
"""Exceptions of the analysis; each message is one line that names the cause."""


class AnalysisError(Exception):
    """Input that cannot be analysed."""


class DumpError(AnalysisError):
    """A dump that is damaged, or lacks what was asked for."""


class TruncatedFrame(DumpError):
    """A dump that ends inside a frame, as when a run was stopped while writing."""


class SceneError(AnalysisError):
    """A scene that is missing, incomplete or out of range."""
