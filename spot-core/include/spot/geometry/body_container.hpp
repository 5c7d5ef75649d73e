// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <optional>

#include "spot/geometry/base_plate.hpp"
#include "spot/geometry/container.hpp"
#include "spot/geometry/spot_buffers.hpp"

namespace spot {

/// A container whose walls are the surface of one body, open at the orifice. Whatever the body has below the height of
/// the orifice is no wall, and nothing passes that height beside the orifice.
class BodyContainer : public Container {
 public:
  BodyContainer(const Orifice& orifice, const SpotBuffers& buffers)
      : orifice_(orifice), buffers_(buffers), base_(orifice) {}

  const Orifice& orifice() const override { return orifice_; }
  std::optional<WallOnPath> first_wall(const Vector3& from, const Vector3& to) const override;

 private:
  /// The nearest wall within reach of a place.
  virtual std::optional<WallContact> nearest_wall(const Vector3& place, double reach) const = 0;

  /// The first wall on a path whose ends are not below the orifice, but for rounding.
  virtual std::optional<WallOnPath> first_wall_above(const Vector3& from, const Vector3& to) const = 0;

  std::optional<Vector3> reflect_spot(const Vector3& start, const Vector3& target) const override;

  Orifice orifice_;
  SpotBuffers buffers_;
  BasePlate base_;
};

}  // namespace spot
