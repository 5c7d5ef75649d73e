// SPDX-License-Identifier: GPL-2.0-or-later
#include "geometry/plane.hpp"

#include "geometry/directions.hpp"
#include "spot/geometry/shapes.hpp"

namespace spot {

bool Plane::revolves_about(const Line& axis, double) const { return normal_.cross(axis.direction).norm() < 1e-12; }

Solid half_space(const Vector3& point, const Vector3& normal) {
  require_finite(point, "the point of a plane");
  const Vector3 inwards = direction_of(normal, "the normal of a plane");
  // One and the same surface for both of its sides.
  const bool up = points_up(inwards);
  return Solid(std::make_shared<Plane>(point, up ? inwards : Vector3(-inwards)), up);
}

Solid block(const Vector3& low, const Vector3& high) {
  if (!(low.array() < high.array()).all())
    throw InvalidContainer(message("a block from (", low.x(), ", ", low.y(), ", ", low.z(), ") to (", high.x(), ", ",
                                   high.y(), ", ", high.z(), ") has no room: each coordinate must increase"));
  Solid block = half_space(low, Vector3::UnitX()) & half_space(high, -Vector3::UnitX());
  for (const int axis : {1, 2})
    block = block & half_space(low, Vector3::Unit(axis)) & half_space(high, -Vector3::Unit(axis));
  return block;
}

}  // namespace spot
