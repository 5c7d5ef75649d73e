// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/geometry/periodic.hpp"

#include "spot/base/errors.hpp"

namespace spot {

namespace {

constexpr const char* names[] = {"x", "y", "z"};

}  // namespace

Periodic::Periodic(const std::optional<Interval>& x, const std::optional<Interval>& y) {
  set(0, x);
  set(1, y);
}

void Periodic::set(int axis, const std::optional<Interval>& interval) {
  if (!interval) return;
  const auto [low, high] = *interval;
  if (!(low < high) || !std::isfinite(low) || !std::isfinite(high))
    throw InvalidContainer(message("ends of the period along ", names[axis], " are ", low, " and ", high,
                                   " but must be finite and in increasing order"));
  const auto a = static_cast<std::size_t>(axis);
  any_ = true;
  low_[a] = low;
  high_[a] = high;
  length_[a] = high - low;
  half_[a] = 0.5 * length_[a];
}

double Periodic::wrapped(double coordinate, int axis) const {
  if (!along(axis) || !std::isfinite(coordinate)) return coordinate;
  coordinate -= length(axis) * std::floor((coordinate - low(axis)) / length(axis));
  // Rounding may leave it at the other end.
  if (coordinate < low(axis)) coordinate += length(axis);
  return coordinate >= high(axis) ? low(axis) : coordinate;
}

double Periodic::shortened(double difference, int axis) const {
  return difference - length(axis) * std::nearbyint(difference / length(axis));
}

Periodic Periodic::on(const Quantum& quantum) const {
  std::array<std::optional<Interval>, 2> intervals;
  for (int axis = 0; axis < 2; ++axis)
    if (along(axis)) intervals[static_cast<std::size_t>(axis)] = {quantum.snap(low(axis)), quantum.snap(high(axis))};
  return {intervals[0], intervals[1]};
}

void Periodic::require_length(double least, const char* why) const {
  for (int axis = 0; axis < 2; ++axis)
    if (along(axis) && !(length(axis) >= least))
      throw InvalidContainer(
          message("period along ", names[axis], " is ", length(axis), " but must be at least ", least, ", ", why));
}

void Periodic::require_same_as(const Periodic& packing, const Quantum& quantum) const {
  if (on(quantum) != packing) throw InvalidContainer("space repeats otherwise in the container than in the packing");
}

}  // namespace spot
