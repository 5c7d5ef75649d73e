// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "spot/base/vector.hpp"

namespace spot {

struct Line {
  Vector3 origin;
  Vector3 direction;
  Vector3 at(double s) const { return origin + s * direction; }
};

/// What a surface's equation is along a line: squared * s^2 + 2 half_linear * s + constant.
struct Quadratic {
  double squared, half_linear, constant;

  double discriminant() const { return half_linear * half_linear - squared * constant; }
  /// The root with + (or -) in front of the square root of the discriminant, found without cancellation; not finite
  /// where there is none. Along lines that change without a jump neither does this, but through infinity.
  double root(bool plus) const;
};

/// An endless smooth surface with an inner side: what shapes are bounded by. Immutable, so any number of threads may
/// ask. A new kind of surface is a new class; where it is bounded by others its edges have to be found (edges.hpp).
class Surface {
 public:
  virtual ~Surface() = default;

  /// Distance of a place, positive on the inner side, negative on the outer (length). Exact to rounding.
  virtual double depth(const Vector3& place) const = 0;

  /// The point of the surface that is nearest; one of them where several are.
  virtual Vector3 nearest(const Vector3& place) const = 0;

  /// Unit normal, to the inner side, at a point of the surface.
  virtual Vector3 normal(const Vector3& point) const = 0;

  /// Its equation along a line. Some roots may lie off the surface, as those on the other nappe of a cone.
  virtual Quadratic along(const Line& line) const = 0;

  /// Numbers that say what it is: lengths, and directions times `size`. Two surfaces of one kind whose numbers are the
  /// same are the same surface.
  virtual std::array<double, 7> numbers(double size) const = 0;

  /// The same, displaced.
  virtual std::shared_ptr<const Surface> moved(const Vector3& by) const = 0;

  /// The sine of the angle at which lines with this unit direction leave it, if it is the same for all of its points or
  /// if some stay in it: 0 where they do. 1 for surfaces without such lines.
  virtual double slant(const Vector3&) const { return 1.0; }

  /// Is it the same after any turn about this axis? Within `tolerance`.
  virtual bool revolves_about(const Line& axis, double tolerance) const = 0;

  /// The axis of what a turning straight line sweeps, or nothing if it is no such surface.
  virtual std::optional<Line> axis() const { return std::nullopt; }

  /// Of such a surface, the straight line in it, of unit direction, at an angle about the axis: in turns, about.
  virtual Line generator(double) const { return {Vector3::Zero(), Vector3::Zero()}; }

  /// The point of a cone, from which its generators start; s is above 0 along them.
  virtual std::optional<Vector3> apex() const { return std::nullopt; }
};

/// The roots of a surface's equation along a line, as multiples of its direction.
class Crossings {
 public:
  explicit Crossings(const Quadratic& equation);
  const double* begin() const { return at_.data(); }
  const double* end() const { return at_.data() + size_; }

 private:
  std::array<double, 2> at_{};
  int size_ = 0;
};

}  // namespace spot
