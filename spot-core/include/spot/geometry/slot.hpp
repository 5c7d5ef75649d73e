// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <optional>

#include "spot/geometry/hole.hpp"

namespace spot {

/// A rectangular hole with sides along x and y.
class Slot : public Hole {
 public:
  /// Widths along x and y (length). Throws InvalidContainer unless both are positive and finite.
  Slot(double x_width, double y_width);

  std::string name() const override;
  double distance(const Vector3& place) const override;
  Vector3 to_rim(const Vector3& place) const override;
  Vector3 keep_inside(double margin, const Vector3& place) const override;
  Vector3 point(double margin, double first, double second) const override;
  double widest_radius() const override;
  double equivalent_radius() const override;
  double half_width(int axis) const override { return half_[axis]; }
  double farthest(const Vector3& place) const override;
  double discharge(const BeverlooLaw& law, double diameter) const override;
  std::shared_ptr<const Hole> without_ends(int axis) const override;
  Solid column(const Vector3& centre) const override;

 private:
  bool ends(int axis) const { return axis != endless_; }

  Vector3 half_;  // widths along x and y
  std::optional<int> endless_;
};

}  // namespace spot
