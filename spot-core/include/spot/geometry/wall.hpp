// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <optional>

#include "spot/base/vector.hpp"
#include "spot/geometry/wall_contact.hpp"

namespace spot {

/// One shape of wall. New shapes are new classes; the rest of spot-core does not change.
class Wall {
 public:
  virtual ~Wall() = default;

  /// The nearest point; a negative distance says that `centre` is behind the wall.
  virtual WallContact nearest(const Vector3& centre) const = 0;

  /// `target`, reflected to the inner side of the surface `buffer` in front of the wall.
  /// Reflection keeps spots that walk along a plane wall uniformly distributed in front of it.
  virtual Vector3 reflect_spot(double buffer, const Vector3& target) const;

  /// Is it none that reflects spots? The mirror image in a curved wall is smaller or larger than what it shows, so
  /// spots would not stay uniform in front of it.
  virtual bool curved() const { return false; }

  /// Where the straight path from the inner side passes this wall. A path that begins behind it meets it at once,
  /// unless it ends on the inner side.
  virtual std::optional<WallOnPath> meet(const Vector3& from, const Vector3& to) const = 0;

  /// As of Container.
  virtual bool may_have_left_to(const Vector3&) const { return true; }

  /// The plane across an axis that this wall is, or nothing.
  virtual std::optional<AxisPlane> axis_plane() const { return std::nullopt; }
};

}  // namespace spot
