// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/orifice.hpp"

#include <algorithm>

#include "geometry/length.hpp"

namespace spot {

Vector3 Orifice::keep_within(double limit, const Vector3& position) const {
  const double dx = position.x() - centre.x();
  const double dy = position.y() - centre.y();
  const double distance = length(dx, dy);
  if (distance <= limit) return position;
  const double scale = std::max(0.0, 2.0 * limit - distance) / distance;
  return {centre.x() + scale * dx, centre.y() + scale * dy, position.z()};
}

std::optional<double> Orifice::passed_at(const Vector3& from, const Vector3& to) const {
  const double before = from.z() - centre.z(), after = to.z() - centre.z();
  if ((before >= 0.0) == (after >= 0.0)) return std::nullopt;
  return before / (before - after);
}

}  // namespace spot
