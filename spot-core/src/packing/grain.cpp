// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/packing/grain.hpp"

#include <cmath>

#include "spot/base/errors.hpp"
#include "spot/packing/point.hpp"

namespace spot {

double radius_in(double diameter, const Grain& grain) {
  const double largest = 0.5 * diameter, smallest = 0.25 * diameter;
  if (grain.radius == 0.0) return largest;
  if (!(grain.radius >= smallest && grain.radius <= largest))
    throw InvalidPacking(message("radius of grain ", grain.id, " is ", grain.radius, " but must be from ", smallest,
                                 " to ", largest, ", a quarter to half of the diameter of the largest grains"));
  return grain.radius;
}

int volume_parts(double diameter, double radius) {
  const double ratio = 2.0 * radius / diameter;
  return static_cast<int>(std::nearbyint(grain_volume * (ratio * ratio * ratio)));
}

}  // namespace spot
