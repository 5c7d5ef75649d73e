#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Prints the hopper's walls, a cone and a cylinder on top of it, as triangles (STL) in metres."""

import math

D = 0.003  # m
PROFILE = [(4 * D, 0), (10 * D, 15 * D), (10 * D, 70 * D)]  # radius and height of the edges
SIDES = 96

print("solid hopper")
for (r, z), (s, y) in zip(PROFILE, PROFILE[1:]):
    for i in range(SIDES):
        # corners on the circle: grains inside this polygon are inside the round wall, too
        a, b = (math.tau * k / SIDES for k in (i, i + 1))
        p, q, t, u = ((R * math.cos(w), R * math.sin(w), h) for R, h, w in ((r, z, a), (r, z, b), (s, y, b), (s, y, a)))
        for corners in ((p, q, t), (p, t, u)):
            print("facet normal 0 0 0\nouter loop", *("vertex %.9g %.9g %.9g" % corner for corner in corners), "endloop\nendfacet", sep="\n")
print("endsolid hopper")
