# SPDX-License-Identifier: GPL-2.0-or-later
"""Meshes of walls, as ASCII STL."""


def write_stl(path, name, triangles, normal="0 0 0"):
    """Write triangles, three corners (x, y, z) each. LIGGGHTS takes normals from the order of the corners, whatever is written."""
    with open(path, "w", encoding="ascii") as stl:
        stl.write(f"solid {name}\n")
        for triangle in triangles:
            stl.write(f"facet normal {normal}\nouter loop\n")
            for corner in triangle:
                stl.write("vertex %.9g %.9g %.9g\n" % tuple(corner))
            stl.write("endloop\nendfacet\n")
        stl.write(f"endsolid {name}\n")
