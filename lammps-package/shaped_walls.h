// SPDX-License-Identifier: GPL-2.0-only
#ifndef SPOT_SHAPED_WALLS_H
#define SPOT_SHAPED_WALLS_H

#include <string>
#include <vector>

#include "spot/geometry/periodic.hpp"
#include "spot/geometry/solid.hpp"

class Words;

/// `walls add shape ...` and `walls cut shape ...`, one after the other: the inside of a silo, in shapes that are
/// written as those of LAMMPS' region command.
class ShapedWalls {
 public:
  /// Reads what follows keyword `walls`. Throws spot::InvalidParameter that names the offending word and what is
  /// allowed, and spot::InvalidContainer for numbers that make no shape.
  void read(Words& words);

  /// Throws spot::InvalidContainer, naming a shape that cannot repeat where space does; see spot::repeated().
  spot::Solid solid(const spot::Periodic& periodic) const;

  /// No place inside is beyond these (length).
  const spot::Vector3& low() const { return low_; }
  const spot::Vector3& high() const { return high_; }

  /// As they were read.
  std::string text() const;

 private:
  struct Shape {
    bool add;  // or cut
    spot::Solid solid;
    spot::Vector3 low, high;  // no place of it is beyond these
    std::string text;
  };
  std::vector<Shape> shapes_;
  spot::Vector3 low_ = spot::Vector3::Zero(), high_ = spot::Vector3::Zero();
};

#endif
