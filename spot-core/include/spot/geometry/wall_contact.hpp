// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <optional>

#include "spot/base/vector.hpp"

namespace spot {

/// The nearest point of a wall, seen from a grain: how far it is from the grain's centre, and the unit
/// normal that points from it to the centre.
struct WallContact {
  double distance;
  Vector3 normal;
};

/// The walls close to one grain. A grain in a corner touches three planes; eight leaves room for odd shapes.
class WallContacts {
 public:
  static constexpr int capacity = 8;

  void clear() { size_ = 0; }
  /// Throws InvalidContainer when more than `capacity` walls are close to one grain.
  void add(const WallContact& contact);
  const WallContact* begin() const { return contacts_.data(); }
  const WallContact* end() const { return contacts_.data() + size_; }

 private:
  std::array<WallContact, capacity> contacts_;
  int size_ = 0;
};

/// A flat wall across an axis.
struct AxisPlane {
  int axis;
  double at;          ///< where it crosses the axis
  bool grains_below;  ///< else above
};

/// Where a straight path meets a wall.
struct WallOnPath {
  double share;    ///< of the path that lies before the wall, 0 to 1
  Vector3 normal;  ///< a unit vector from the wall to the side that the path comes from; zero where the wall has none
};

}  // namespace spot
