// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "spot/base/vector.hpp"
#include "spot/geometry/outlets.hpp"
#include "spot/geometry/periodic.hpp"
#include "spot/geometry/wall_contact.hpp"

namespace spot {

/// What holds the grains: walls near a point, the outlets, and where spots may go. z points up.
class Container {
 public:
  virtual ~Container() = default;

  /// Is this grain centre on the inner side of every wall?
  virtual bool contains(const Vector3& centre) const = 0;

  /// Fills `contacts` with all walls within `reach` of a grain centre.
  virtual void contacts(const Vector3& centre, double reach, WallContacts& contacts) const = 0;

  /// The flat walls across axes, for which there is a short cut.
  virtual const std::vector<AxisPlane>& axis_planes() const;

  /// As contacts(), without those of axis_planes().
  virtual void other_contacts(const Vector3& centre, double reach, WallContacts& contacts) const {
    this->contacts(centre, reach, contacts);
  }

  /// May several threads ask at the same time, whatever they ask?
  virtual bool concurrent() const { return true; }

  virtual const Outlets& outlets() const = 0;

  /// Along which axes space repeats. All questions may be asked of places in any of its cells.
  virtual const Periodic& periodic() const;

  /// Is this place over or under an outlet, or no farther than `margin` beside it?
  bool is_over_outlet(const Vector3& place, double margin = 0.0) const;

  /// The outlet, or the image of one, nearest to a place.
  const Outlet& nearest_outlet(const Vector3& place) const;
  std::size_t nearest_outlet_index(const Vector3& place) const;

  /// May a grain that is here now, below the outlets, have come out of one? Else it went through a wall.
  virtual bool may_have_left_to(const Vector3&) const { return true; }

  /// The first wall on the straight path between two places. Below the height of the outlets there are none.
  virtual std::optional<WallOnPath> first_wall(const Vector3& from, const Vector3& to) const = 0;

  /// Where a spot at `start` that wants to step to `target` ends, at least its buffer away from each wall, if it was
  /// so before. The step is straight, and no wall lies across it. Walls that are flat or lean reflect it. Where
  /// another wall is too close, or it is too narrow for that, only its upward part is taken, and no step at all where
  /// that would meet a wall. So spots that are uniform stay so in every shape that is as wide at each height.
  Vector3 keep_spot_inside(const Vector3& start, const Vector3& target) const;

  /// A message for every spot, thrown as InvalidContainer, if spots of this radius cannot enter.
  void require_entrance(double spot_radius) const;

 private:
  /// `target`, reflected until the spot fits there and no wall lies across the step from `start`; or nothing.
  virtual std::optional<Vector3> reflect_spot(const Vector3& start, const Vector3& target) const = 0;
};

}  // namespace spot
