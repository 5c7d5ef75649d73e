// SPDX-License-Identifier: GPL-2.0-only
#ifndef SPOT_SHAPED_WALLS_H
#define SPOT_SHAPED_WALLS_H

#include <optional>
#include <string>

#include "spot/geometry/solid.hpp"

class Words;

/// `walls add shape ...` and `walls cut shape ...`, one after the other: the inside of a silo, in shapes that are
/// written as those of LAMMPS' region command.
class ShapedWalls {
 public:
  /// Reads what follows keyword `walls`. Throws spot::InvalidParameter that names the offending word and what is
  /// allowed, and spot::InvalidContainer for numbers that make no shape.
  void read(Words& words);

  const spot::Solid& solid() const { return *solid_; }

  /// No place inside is beyond these (length).
  const spot::Vector3& low() const { return low_; }
  const spot::Vector3& high() const { return high_; }

  /// As they were read.
  const std::string& text() const { return text_; }

 private:
  std::optional<spot::Solid> solid_;
  spot::Vector3 low_ = spot::Vector3::Zero(), high_ = spot::Vector3::Zero();
  std::string text_;
};

#endif
