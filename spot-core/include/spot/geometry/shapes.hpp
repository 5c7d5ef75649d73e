// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "spot/base/vector.hpp"
#include "spot/geometry/solid.hpp"

namespace spot {

// Shapes that silos are made of; combine them with &, | and ~. All throw InvalidContainer unless every number is
// finite, directions are not zero, and radii are positive.

/// All that is on the side of a plane to which `normal` points, with the plane through `point`.
Solid half_space(const Vector3& point, const Vector3& normal);

/// The block between two corners. Throws InvalidContainer unless each coordinate of `low` is below that of `high`.
Solid block(const Vector3& low, const Vector3& high);

Solid sphere(const Vector3& centre, double radius);

/// An endless cylinder.
Solid cylinder(const Vector3& point, const Vector3& axis, double radius);

/// A cylinder with flat ends, from the centre of one to that of the other.
Solid cylinder_between(const Vector3& from, const Vector3& to, double radius);

/// An endless circular cone that opens along `axis` from its point, by `slope` of radius over height (above 0).
Solid cone(const Vector3& point, const Vector3& axis, double slope);

/// A cone with flat ends, of the given radii around their centres; one may be 0, and they must differ.
Solid cone_between(const Vector3& from, double radius_from, const Vector3& to, double radius_to);

}  // namespace spot
