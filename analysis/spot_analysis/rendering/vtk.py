# SPDX-License-Identifier: GPL-2.0-or-later
"""Grains as points in files of VTK, which ParaView opens; the legacy format, binary (https://docs.vtk.org, "VTK file formats")."""

import numpy as np


def write_points(path, grains, values, name):
    """Positions in d of all ``grains`` with their ids, diameters and ``values`` (n,) under ``name``."""
    count = len(grains.ids)
    with open(path, "wb") as handle:
        def section(header, array):
            handle.write(f"{header}\n".encode() + array.tobytes() + b"\n")

        handle.write(b"# vtk DataFile Version 3.0\n" + f"t = {grains.time:.9g}\n".encode() + b"BINARY\nDATASET POLYDATA\n")
        section(f"POINTS {count} float", grains.positions.astype(">f4"))
        section(f"VERTICES {count} {2 * count}", np.stack([np.ones(count), np.arange(count)], axis=1).astype(">i4"))
        handle.write(f"POINT_DATA {count}\n".encode())
        for title, kind, array in (("id", "int", grains.ids.astype(">i4")), ("diameter", "float", grains.diameters.astype(">f4")),
                                   (name, "float", values.astype(">f4"))):
            section(f"SCALARS {title} {kind} 1\nLOOKUP_TABLE default", array)
