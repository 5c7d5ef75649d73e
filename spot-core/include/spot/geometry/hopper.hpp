// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <optional>

#include "spot/geometry/container.hpp"

namespace spot {

/// The tangent of the half-angle, from the vertical, of the hopper that ends at an outlet: of walls that stand at its
/// rim and widen evenly with height, as far up as the outlet's widest radius, and on all sides alike; at a slot, on the
/// two sides of its smaller width. 0 for a pipe as wide as the outlet; none for a flat base, and walls of other forms.
/// Exact up to rounding where walls are.
std::optional<double> hopper_slope(const Container& container, const Outlet& outlet);

/// What a hopper multiplies the outflow of Beverloo's law with, (tan a tan f)^-0.35, for its half-angle a and the
/// material's angle f, below 90 degrees in sum; 1 beyond, as over a flat base. Rose and Tanaka, The Engineer 208, 465
/// (1959), for cones; quoted from memory, and not checked against the paper. Nedderman, Statics and Kinematics of
/// Granular Materials (1992), has f as the angle of the stagnant zone's side with the horizontal; the angle of repose
/// is often taken in its place.
double hopper_factor(double tan_half_angle, double tan_material_angle);

/// Below this half-angle the factor grows without a bound (degrees).
constexpr double least_half_angle = 10.0;

/// Of an angle in degrees, the same bits everywhere.
double tangent(double degrees);

}  // namespace spot
