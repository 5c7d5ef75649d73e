// SPDX-License-Identifier: GPL-2.0-only
#ifndef SPOT_SHAPED_WALLS_H
#define SPOT_SHAPED_WALLS_H

#include <optional>
#include <string>
#include <vector>

#include "spot/geometry/periodic.hpp"
#include "spot/geometry/solid.hpp"

class Words;

/// `walls add shape ...` and `walls cut shape ...`, one after the other: the inside of a silo, in shapes that are
/// written as those of LAMMPS' region command.
class ShapedWalls {
 public:
  /// A cone, or a cylinder, about a vertical axis; places of its ends, and its radii there.
  struct Upright {
    double x, y, low, high, radius_low, radius_high;
  };

  /// Reads what follows keyword `walls`. Throws spot::InvalidParameter that names the offending word and what is
  /// allowed, and spot::InvalidContainer for numbers that make no shape.
  void read(Words& words);

  /// Throws spot::InvalidContainer, naming a shape that cannot repeat where space does; see spot::repeated().
  spot::Solid solid(const spot::Periodic& periodic) const;

  /// No place inside is beyond these (length).
  const spot::Vector3& low() const { return low_; }
  const spot::Vector3& high() const { return high_; }

  /// The cone, if all there is are one that widens upwards and a cylinder on top, as wide and about the same axis; or
  /// none.
  const Upright* cone_under_cylinder() const;

  /// As they were read.
  std::string text() const;

 private:
  struct Shape {
    bool add;  // or cut
    spot::Solid solid;
    spot::Vector3 low, high;  // no place of it is beyond these
    std::optional<Upright> upright;
    std::string text;
  };
  std::vector<Shape> shapes_;
  spot::Vector3 low_ = spot::Vector3::Zero(), high_ = spot::Vector3::Zero();
};

#endif
