// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "geometry/curve.hpp"
#include "spot/geometry/surface.hpp"

namespace spot {

/// The edges between two surfaces that are not the same; they must outlive them. Straight and circular ones are exact:
/// of two planes, of planes or cylinders along one direction, of cones and what goes through their points, of spheres
/// and planes, and of what turns about one axis. Others are curves over the generators of a cylinder or cone. Parts
/// farther than 1e13 tolerances from the origins of these generators are left out. Throws InvalidContainer for two
/// surfaces of which neither is swept by a straight line nor are both planes or spheres, and where they are almost
/// parallel: a cylinder's axis within 1e-3 of a plane's or cylinder's direction, or the point of a cone within 1e6
/// tolerances of a plane or another point, but not exactly.
std::vector<std::unique_ptr<Curve>> edges_between(const Surface& a, const Surface& b, double tolerance);

}  // namespace spot
