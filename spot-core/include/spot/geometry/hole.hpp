// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <memory>
#include <string>

#include "spot/base/vector.hpp"
#include "spot/geometry/beverloo.hpp"
#include "spot/geometry/solid.hpp"

namespace spot {

/// The shape of a horizontal hole: convex, and its own mirror image along x and along y. New shapes are new classes;
/// the rest of spot-core does not change. Places are seen from its centre; their heights do not count.
class Hole {
 public:
  virtual ~Hole() = default;

  /// What errors call it, with its measures.
  virtual std::string name() const = 0;

  /// From a place to the hole, or, below 0, from a place in it to its rim (length).
  virtual double distance(const Vector3& place) const = 0;

  /// The horizontal unit vector from a place in the hole to the nearest of its rim, or zero where that is on all sides.
  virtual Vector3 to_rim(const Vector3& place) const = 0;

  /// The place, its height kept, mirrored to be at least `margin` inside the rim; on the centre line if the hole is too
  /// narrow for that.
  virtual Vector3 keep_inside(double margin, const Vector3& place) const = 0;

  /// Uniformly distributed over what is at least `margin` inside the rim, for two uniform numbers from 0 to 1; on the
  /// centre line if there is nothing. At height 0.
  virtual Vector3 point(double margin, double first, double second) const = 0;

  /// Of the widest circle in it (length).
  virtual double widest_radius() const = 0;

  /// Of a circle of the same area (length).
  virtual double equivalent_radius() const = 0;

  /// From its centre to where it ends along x (0) or y (1) (length).
  virtual double half_width(int axis) const = 0;

  /// From a place to that place in the hole which is farthest from it (length).
  virtual double farthest(const Vector3& place) const = 0;

  /// By Beverloo's law, how many grains of a diameter leave through it per time, over their number per volume and the
  /// square root of gravity (length^2.5); 0 where it is too narrow.
  virtual double discharge(const BeverlooLaw& law, double diameter) const = 0;

  /// The same without ends along x (0) or y (1), where space repeats as soon as it ends; none if its sides are not
  /// straight.
  virtual std::shared_ptr<const Hole> without_ends(int) const { return nullptr; }

  /// All that is above and below the hole, with this place as its centre.
  virtual Solid column(const Vector3& centre) const = 0;
};

}  // namespace spot
