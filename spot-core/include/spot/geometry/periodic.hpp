// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "spot/base/quantum.hpp"
#include "spot/base/vector.hpp"

namespace spot {

/// From where to where a cell of space reaches along an axis (length).
struct Interval {
  double low, high;
};

/// Along which of x and y space repeats, and how: what leaves the cell on one side comes in on the other. Never along
/// z, which is up.
class Periodic {
 public:
  /// Nowhere.
  Periodic() = default;

  /// Along the axes whose interval is given. Throws InvalidContainer unless its ends are finite and in increasing
  /// order.
  Periodic(const std::optional<Interval>& x, const std::optional<Interval>& y);

  bool any() const { return any_; }
  bool along(int axis) const { return length(axis) < infinite; }

  /// Ends of the cell, and its length, the period; infinite along an axis on which nothing repeats.
  double low(int axis) const { return low_[static_cast<std::size_t>(axis)]; }
  double high(int axis) const { return high_[static_cast<std::size_t>(axis)]; }
  double length(int axis) const { return length_[static_cast<std::size_t>(axis)]; }

  /// The coordinate, in the cell: from low, inclusive, to high, exclusive. Those in it keep their bits; multiples of a
  /// quantum of which low and length are multiples, too, are moved exactly.
  double wrap(double coordinate, int axis) const {
    return coordinate >= low(axis) && coordinate < high(axis) ? coordinate : wrapped(coordinate, axis);
  }
  void wrap(double& x, double& y) const {
    if (!any_) return;
    x = wrap(x, 0);
    y = wrap(y, 1);
  }
  Vector3 wrap(const Vector3& position) const { return {wrap(position.x(), 0), wrap(position.y(), 1), position.z()}; }

  /// The difference of two coordinates, each in any cell, to the nearest image: at most half a period, of either sign.
  /// Exact as wrap() is, and the opposite of that of the opposite.
  double nearest(double difference, int axis) const {
    return std::abs(difference) <= half_[static_cast<std::size_t>(axis)] ? difference : shortened(difference, axis);
  }
  /// Of both coordinates of a difference; hardly costs anything where nothing repeats.
  void shorten(double& x, double& y) const {
    if (!any_) return;
    x = nearest(x, 0);
    y = nearest(y, 1);
  }
  Vector3 nearest(const Vector3& difference) const {
    return {nearest(difference.x(), 0), nearest(difference.y(), 1), difference.z()};
  }

  /// The same with ends that are the nearest multiples of the quantum. Throws InvalidContainer if nothing is left
  /// between them.
  Periodic on(const Quantum& quantum) const;

  /// Throws InvalidContainer, naming the axis, if a period is shorter than this; `why` ends the message.
  void require_length(double least, const char* why) const;

  /// Throws InvalidContainer unless, on this quantum, space repeats as it does in a packing.
  void require_same_as(const Periodic& packing, const Quantum& quantum) const;

  bool operator==(const Periodic& other) const { return low_ == other.low_ && high_ == other.high_; }
  bool operator!=(const Periodic& other) const { return !(*this == other); }

 private:
  static constexpr double infinite = std::numeric_limits<double>::infinity();

  void set(int axis, const std::optional<Interval>& interval);
  double wrapped(double coordinate, int axis) const;
  double shortened(double difference, int axis) const;

  bool any_ = false;
  std::array<double, 3> low_ = {-infinite, -infinite, -infinite}, high_ = {infinite, infinite, infinite};
  std::array<double, 3> length_ = high_, half_ = high_;
};

}  // namespace spot
