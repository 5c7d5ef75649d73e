// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "spot/base/vector.hpp"
#include "spot/geometry/surface.hpp"

namespace spot {

/// A set of places: one side of a surface, or unions, intersections and complements of such sets. Made by the functions
/// of shapes.hpp; cheap to copy.
class Solid {
 public:
  enum class Kind { side, intersection, union_of };

  /// The inner or outer side of a surface, with the surface.
  Solid(std::shared_ptr<const Surface> surface, bool inner);

  friend Solid operator&(const Solid& a, const Solid& b) { return Solid(Kind::intersection, {a, b}); }
  friend Solid operator|(const Solid& a, const Solid& b) { return Solid(Kind::union_of, {a, b}); }
  /// All that is not inside, with the boundary.
  Solid operator~() const;

  bool contains(const Vector3& place) const;

  Kind kind() const { return kind_; }
  const std::vector<Solid>& parts() const { return parts_; }
  const std::shared_ptr<const Surface>& surface() const { return surface_; }
  bool inner() const { return inner_; }

 private:
  Solid(Kind kind, std::vector<Solid> parts) : kind_(kind), parts_(std::move(parts)) {}

  Kind kind_;
  std::vector<Solid> parts_;
  std::shared_ptr<const Surface> surface_;  // of a side
  bool inner_ = true;
};

}  // namespace spot
