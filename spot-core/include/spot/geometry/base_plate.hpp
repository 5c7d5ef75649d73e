// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "spot/geometry/outlets.hpp"
#include "spot/geometry/wall.hpp"

namespace spot {

/// A thin horizontal plate with holes. Grains over a hole see its rim, by the nearest point of it.
class BasePlate : public Wall {
 public:
  explicit BasePlate(const Outlets& outlets);
  /// Grains below the plate see its lower side.
  WallContact nearest(const Vector3& centre) const override;
  /// Reflects into the nearest hole at constant height, so that a spot on its way up through it is not held back.
  Vector3 reflect_spot(double buffer, const Vector3& target) const override;
  /// From either side.
  std::optional<WallOnPath> meet(const Vector3& from, const Vector3& to) const override;
  /// Below a hole grains spread no farther than they have come down.
  bool may_have_left_to(const Vector3& centre) const override;

 private:
  Outlets outlets_;
};

}  // namespace spot
