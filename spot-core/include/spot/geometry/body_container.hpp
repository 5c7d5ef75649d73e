// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <optional>

#include "spot/geometry/base_plate.hpp"
#include "spot/geometry/container.hpp"
#include "spot/geometry/spot_buffers.hpp"

namespace spot {

/// A container whose walls are the surface of one body, open at the outlets. Whatever the body has below their height
/// is no wall, and nothing passes that height beside them.
class BodyContainer : public Container {
 public:
  /// Where space repeats, so does the body. Throws InvalidContainer, naming the outlet, if one reaches out of the cell,
  /// or is no wider than spots keep from side walls.
  BodyContainer(const Outlets& outlets, const SpotBuffers& buffers, const Periodic& periodic = {});

  const Outlets& outlets() const override { return outlets_; }
  const Periodic& periodic() const override { return periodic_; }
  std::optional<WallOnPath> first_wall(const Vector3& from, const Vector3& to) const override;

 private:
  /// The nearest wall within reach of a place, which may be in any cell.
  virtual std::optional<WallContact> nearest_wall(const Vector3& place, double reach) const = 0;

  /// The first wall on a path in the cell whose ends are not below the outlets, but for rounding.
  virtual std::optional<WallOnPath> first_wall_above(const Vector3& from, const Vector3& to) const = 0;

  std::optional<Vector3> reflect_spot(const Vector3& start, const Vector3& target) const override;
  std::optional<Vector3> reflect_in_cell(const Vector3& start, const Vector3& target) const;
  std::optional<WallOnPath> first_wall_in_cell(const Vector3& from, const Vector3& to) const;
  bool meets_base(const Vector3& from, const Vector3& to) const;
  bool is_curved_and_upright(const Vector3& place, const Vector3& normal, double length) const;

  Outlets outlets_;
  Periodic periodic_;
  SpotBuffers buffers_;
  BasePlate base_;
};

}  // namespace spot
