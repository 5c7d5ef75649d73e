// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/walk/nonaffine_motion.hpp"

#include <cmath>

#include "spot/base/random.hpp"

namespace spot {

namespace {

/// t is uniform from -sqrt(3) to sqrt(3), which is so many parts.
constexpr double parts = 32767.0;

/// Levels are told apart by their remainder: no grain falls by so many between two windows.
constexpr std::int64_t levels = 32767;

std::int16_t parts_of(double uniform) {
  return static_cast<std::int16_t>(std::nearbyint((2.0 * uniform - 1.0) * parts));
}

/// Where in its level a grain starts: a uniform number that differs from id to id (Weyl sequence of the golden ratio).
double phase(std::int64_t id) {
  return static_cast<double>((static_cast<std::uint64_t>(id) * 0x9E3779B97F4A7C15u) >> 11) * 0x1p-53;
}

}  // namespace

double NonaffineMotion::unit() const { return strength_ * std::sqrt(3.0) / parts; }

bool NonaffineMotion::update(Tilt& tilt, std::int64_t id, double z) const {
  const auto level = static_cast<std::int64_t>(std::floor(z / length_ + phase(id)));
  const auto short_level = static_cast<std::int16_t>(((level % levels) + levels) % levels + 1);
  if (tilt.level == short_level) return false;
  const auto numbers =
      uniform(seed_, RandomPurpose::nonaffine, static_cast<std::uint64_t>(id), static_cast<std::uint64_t>(level));
  tilt = {parts_of(numbers[0]), parts_of(numbers[1]), parts_of(numbers[2]), short_level};
  return true;
}

}  // namespace spot
