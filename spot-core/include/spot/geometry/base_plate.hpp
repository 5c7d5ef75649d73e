// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "spot/geometry/orifice.hpp"
#include "spot/geometry/wall.hpp"

namespace spot {

/// A thin horizontal plate with a round hole. Grains over the hole see its rim, a circular edge.
class BasePlate : public Wall {
 public:
  explicit BasePlate(const Orifice& orifice);
  /// Grains below the plate see its lower side.
  WallContact nearest(const Vector3& centre) const override;
  /// Reflects towards the axis at constant height, so that a spot on its way up through the hole is not held back.
  Vector3 reflect_spot(double buffer, const Vector3& target) const override;
  /// From either side.
  std::optional<WallOnPath> meet(const Vector3& from, const Vector3& to) const override;
  /// Below the hole grains spread no farther than they have come down.
  bool may_have_left_to(const Vector3& centre) const override;

 private:
  Orifice orifice_;
};

}  // namespace spot
