// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "spot/packing/point.hpp"

namespace spot {

// Places in quanta, in 32 bits that wrap around; see CellLattice.

inline std::int32_t wrap(std::int64_t quanta) { return static_cast<std::int32_t>(static_cast<std::uint64_t>(quanta)); }
inline std::int32_t add(std::int32_t a, std::int32_t b) { return wrap(static_cast<std::int64_t>(a) + b); }
inline std::int32_t minus(std::int32_t a, std::int32_t b) { return wrap(static_cast<std::int64_t>(a) - b); }

inline Point minus(const Point& a, const Point& b) {
  return {minus(a.x, b.x), minus(a.y, b.y), minus(a.z, b.z), Point::free};
}

/// Leaves the state of `to` alone.
inline void add(Point& to, const Point& by) {
  to.x = add(to.x, by.x);
  to.y = add(to.y, by.y);
  to.z = add(to.z, by.z);
}

inline constexpr Point nobody = {0, 0, 0, Point::empty};

inline double square(double value) { return value * value; }

inline double squared_distance(const Point& a, const Point& b) {
  return square(minus(a.x, b.x)) + square(minus(a.y, b.y)) + square(minus(a.z, b.z));
}

/// An upper bound, in whole quanta, of the length of a push or step.
inline std::int32_t length_of(const Point& by) {
  const double squared = square(by.x) + square(by.y) + square(by.z);
  return static_cast<std::int32_t>(std::min(std::sqrt(squared), 1e9)) + 1;
}

/// How deep the grain of a push overlaps any other: 1 - r^2/d^2.
inline float depth_of(const Point& push) {
  float depth;
  std::memcpy(&depth, &push.state, sizeof depth);
  return depth;
}

}  // namespace spot
