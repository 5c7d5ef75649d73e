// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

#include "spot/base/aligned_vector.hpp"
#include "spot/packing/point.hpp"
#include "spot/walk/nonaffine_motion.hpp"

namespace spot {

/// Where grains are while moves displace them, with an array for each coordinate, so that a vector holds as many
/// grains as it has numbers.
struct Coordinates {
  AlignedVector<std::int32_t> x, y, z;
  AlignedVector<float> state_squared;  ///< of a Point's state, which counts as a fourth coordinate

  void set(std::size_t slot, const Point& point) {
    x[slot] = point.x;
    y[slot] = point.y;
    z[slot] = point.z;
    state_squared[slot] = static_cast<float>(point.state) * static_cast<float>(point.state);
  }
  Point at(std::size_t slot, std::int32_t state) const { return {x[slot], y[slot], z[slot], state}; }
};

/// Tilts of grains in such arrays.
struct Tilts {
  AlignedVector<std::int16_t> x, y, z, level;

  void set(std::size_t slot, const NonaffineMotion::Tilt& tilt) {
    x[slot] = tilt.x;
    y[slot] = tilt.y;
    z[slot] = tilt.z;
    level[slot] = tilt.level;
  }
  NonaffineMotion::Tilt operator[](std::size_t slot) const { return {x[slot], y[slot], z[slot], level[slot]}; }
};

}  // namespace spot
