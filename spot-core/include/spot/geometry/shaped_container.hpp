// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <optional>

#include "spot/geometry/body_container.hpp"
#include "spot/geometry/boundary.hpp"
#include "spot/geometry/solid.hpp"

namespace spot {

/// A container that is the inside of a solid from the height of the outlets upwards: the solid is cut off there, and
/// the flat base that this makes, if any, has the outlets as its holes. Distances are exact as those of Boundary with
/// the radius of the narrowest outlet as its size. Any number of threads may ask.
class ShapedContainer : public BodyContainer {
 public:
  /// Throws InvalidContainer unless the buffers are not negative, and all of every outlet opens into the solid; and as
  /// Boundary does.
  ///
  /// Where space repeats, the solid must be made of shapes that do, by repeated(); its walls are asked for up to a
  /// period away at most.
  ShapedContainer(const Solid& solid, const Outlets& outlets, const SpotBuffers& buffers,
                  const Periodic& periodic = {});

  bool contains(const Vector3& centre) const override;
  void contacts(const Vector3& centre, double reach, WallContacts& contacts) const override;
  bool may_have_left_to(const Vector3& centre) const override;

 private:
  std::optional<WallContact> nearest_wall(const Vector3& place, double reach) const override;
  std::optional<WallOnPath> first_wall_above(const Vector3& from, const Vector3& to) const override;
  void require_mouth(const Outlet& outlet) const;

  Boundary boundary_;
};

}  // namespace spot
