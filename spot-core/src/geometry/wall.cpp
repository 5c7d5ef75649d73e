// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/wall.hpp"

namespace spot {

Vector3 Wall::reflect_spot(double buffer, const Vector3& target) const {
  const WallContact contact = nearest(target);
  if (contact.distance >= buffer) return target;
  return target + 2.0 * (buffer - contact.distance) * contact.normal;
}

}  // namespace spot
