// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/spot_population.hpp"

#include <algorithm>

namespace spot {

namespace {

/// Heap order: the spot with the earliest step on top, ties by id.
bool later(const Spot& a, const Spot& b) {
  return a.next_step != b.next_step ? a.next_step > b.next_step : a.id > b.id;
}

}  // namespace

SpotPopulation::SpotPopulation(const SpotParameters& parameters, const Container& container)
    : walk_(parameters, container), next_birth_(walk_.time_before_birth(0)) {}

void SpotPopulation::settle() {
  if (in_hand_) std::push_heap(spots_.begin(), spots_.end(), later);
  in_hand_ = false;
}

void SpotPopulation::give_birth(const Container& container) {
  spots_.push_back(walk_.birth(born_, next_birth_, container));
  std::push_heap(spots_.begin(), spots_.end(), later);
  next_birth_ += walk_.time_before_birth(++born_);
}

std::optional<Move> SpotPopulation::next_move(double time, const Container& container) {
  settle();
  while (next_birth_ <= time && (spots_.empty() || next_birth_ <= spots_.front().next_step)) give_birth(container);
  if (spots_.empty() || spots_.front().next_step > time) return std::nullopt;
  std::pop_heap(spots_.begin(), spots_.end(), later);
  in_hand_ = true;
  return walk_.step(spots_.back(), container);
}

void SpotPopulation::remove_last_moved() {
  spots_.pop_back();
  in_hand_ = false;
}

}  // namespace spot
