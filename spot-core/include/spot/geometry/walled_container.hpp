// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "spot/geometry/container.hpp"
#include "spot/geometry/wall.hpp"

namespace spot {

/// A container made of walls, each with the buffer that spots keep from it.
class WalledContainer : public Container {
 public:
  /// An empty space with outlets.
  explicit WalledContainer(const Outlets& outlets) : outlets_(outlets) {}

  void add(std::unique_ptr<Wall> wall, double spot_buffer);

  /// Space repeats like this from now on. Walls are those of the cell: where one meets an end of it, it has to go on in
  /// the next cell as it does in space. Throws InvalidContainer if an outlet reaches out of the cell, or a flat wall
  /// stands across an axis along which it repeats.
  void repeat(const Periodic& periodic);
  const Periodic& periodic() const override { return periodic_; }

  bool contains(const Vector3& centre) const override;
  void contacts(const Vector3& centre, double reach, WallContacts& contacts) const override;
  const std::vector<AxisPlane>& axis_planes() const override { return axis_planes_; }
  void other_contacts(const Vector3& centre, double reach, WallContacts& contacts) const override;
  const Outlets& outlets() const override { return outlets_; }
  bool may_have_left_to(const Vector3& centre) const override;
  std::optional<WallOnPath> first_wall(const Vector3& from, const Vector3& to) const override;

 private:
  std::optional<Vector3> reflect_spot(const Vector3& start, const Vector3& target) const override;

  struct Bounded {
    std::unique_ptr<Wall> wall;
    double spot_buffer;
  };
  void require_no_period_across(const AxisPlane& plane) const;
  std::optional<Vector3> reflect_in_cell(const Vector3& start, const Vector3& target) const;
  std::optional<WallOnPath> first_wall_in_cell(const Vector3& from, const Vector3& to) const;

  Outlets outlets_;
  Periodic periodic_;
  std::vector<Bounded> walls_;
  std::vector<AxisPlane> axis_planes_;  // some of them once more
};

}  // namespace spot
