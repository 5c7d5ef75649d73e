// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/spot_population.hpp"

#include <algorithm>
#include <cmath>

#include "spot/random.hpp"

namespace spot {

namespace {

/// Heap order: the spot with the earliest step on top, ties by id.
bool later(const Spot& a, const Spot& b) {
  return a.next_step != b.next_step ? a.next_step > b.next_step : a.id > b.id;
}

double time_between_births(const SpotParameters& p, std::int64_t id) {
  return exponential(uniform(p.seed, RandomPurpose::birth, static_cast<std::uint64_t>(id), 0)[0], p.injection_rate);
}

/// Numbers of one step: waiting time before it, and its direction.
std::array<double, 4> numbers_of_step(const SpotParameters& p, const Spot& spot) {
  return uniform(p.seed, RandomPurpose::step, static_cast<std::uint64_t>(spot.id),
                 static_cast<std::uint64_t>(spot.steps));
}

/// One of the four vectors (+-dx, 0, dz), (0, +-dx, dz) (2006; trap: 2010 prints diagonals that spread twice as fast).
Vector3 step_vector(const SpotParameters& p, double uniform) {
  switch (static_cast<int>(4.0 * uniform)) {
    case 0: return {p.step_width, 0.0, p.step_height};
    case 1: return {-p.step_width, 0.0, p.step_height};
    case 2: return {0.0, p.step_width, p.step_height};
    default: return {0.0, -p.step_width, p.step_height};
  }
}

}  // namespace

SpotPopulation::SpotPopulation(const SpotParameters& parameters, const Container& container)
    : parameters_(parameters) {
  parameters_.validate();
  container.require_entrance(parameters_.radius);
  next_birth_ = time_between_births(parameters_, 0);
}

void SpotPopulation::settle() {
  if (in_hand_) std::push_heap(spots_.begin(), spots_.end(), later);
  in_hand_ = false;
}

void SpotPopulation::give_birth(const Container& container) {
  const std::int64_t id = born_++;
  const auto numbers = uniform(parameters_.seed, RandomPurpose::birth, static_cast<std::uint64_t>(id), 0);
  const Orifice& orifice = container.orifice();
  const double from_axis = (orifice.radius - parameters_.radius) * std::sqrt(numbers[1]);
  const double angle = 2.0 * 3.14159265358979323846 * numbers[2];
  Spot spot{id, 0, orifice.centre, next_birth_};
  spot.position += Vector3(from_axis * std::cos(angle), from_axis * std::sin(angle), -parameters_.radius);
  spot.next_step += exponential(numbers_of_step(parameters_, spot)[0], parameters_.move_rate());
  spots_.push_back(spot);
  std::push_heap(spots_.begin(), spots_.end(), later);
  next_birth_ += time_between_births(parameters_, born_);
}

std::optional<Move> SpotPopulation::next_move(double time, const Container& container) {
  settle();
  while (next_birth_ <= time && (spots_.empty() || next_birth_ <= spots_.front().next_step)) give_birth(container);
  if (spots_.empty() || spots_.front().next_step > time) return std::nullopt;

  std::pop_heap(spots_.begin(), spots_.end(), later);
  in_hand_ = true;
  Spot& spot = spots_.back();
  const Vector3 start = spot.position;
  const double when = spot.next_step;
  const Vector3 step = step_vector(parameters_, numbers_of_step(parameters_, spot)[1]);
  spot.position = container.keep_spot_inside(start, start + step);
  ++spot.steps;
  spot.next_step += exponential(numbers_of_step(parameters_, spot)[0], parameters_.move_rate());
  return Move{when, spot.id, 0.5 * (start + spot.position), spot.position - start};
}

void SpotPopulation::remove_last_moved() {
  spots_.pop_back();
  in_hand_ = false;
}

}  // namespace spot
