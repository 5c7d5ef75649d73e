// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include "spot/geometry/hole.hpp"

namespace spot {

/// A circular hole.
class RoundHole : public Hole {
 public:
  /// Throws InvalidContainer unless the radius is positive and finite.
  explicit RoundHole(double radius);

  std::string name() const override;
  double distance(const Vector3& place) const override;
  Vector3 to_rim(const Vector3& place) const override;
  Vector3 keep_inside(double margin, const Vector3& place) const override;
  Vector3 point(double margin, double first, double second) const override;
  double widest_radius() const override { return radius_; }
  double equivalent_radius() const override { return radius_; }
  double half_width(int) const override { return radius_; }
  double farthest(const Vector3& place) const override;
  double discharge(const BeverlooLaw& law, double diameter) const override;
  Solid column(const Vector3& centre) const override;

 private:
  double radius_;
};

}  // namespace spot
