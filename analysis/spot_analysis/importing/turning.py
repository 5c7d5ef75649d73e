# SPDX-License-Identifier: GPL-2.0-or-later
"""A packing turned so that gravity points along -z."""

import numpy as np

from ..base.errors import AnalysisError


def direction(words):
    """The unit vector (3,) of an axis, such as ``-y``, or of three numbers; raises AnalysisError where it is none."""
    text = " ".join(words)
    try:
        if len(words) == 1 and words[0].lstrip("+-") in ("x", "y", "z") and len(words[0]) <= 2:
            vector = np.zeros(3)
            vector["xyz".index(words[0][-1])] = -1.0 if words[0].startswith("-") else 1.0
        else:
            vector = np.array([float(word) for word in words])
    except ValueError:
        vector = np.zeros(0)
    if vector.shape != (3,) or not np.isfinite(vector).all() or not vector.any():
        raise AnalysisError(f"--gravity {text}: an axis, such as -y, or the three numbers of a vector")
    return vector / np.linalg.norm(vector)


def turned(positions, gravity):
    """Positions (n, 3) after the smallest rotation that takes the unit vector ``gravity`` (3,) to -z.

    Rodrigues' formula; of the half turn that takes +z to -z, the one about x. Turns between axes move no digit.
    """
    up = -gravity
    cosine = up[2]
    if cosine < -1 + 1e-12:
        return positions * [1.0, -1.0, -1.0]
    cross = np.array([[0, 0, -up[0]], [0, 0, -up[1]], [up[0], up[1], 0]])  # of up x z
    return positions @ (np.eye(3) + cross + cross @ cross / (1 + cosine)).T
