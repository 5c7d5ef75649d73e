// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/spot_population.hpp"

#include <algorithm>

#include "packed.hpp"

namespace spot {

namespace {

/// Heap order: the spot with the earliest step on top, ties by id.
bool later(const Spot& a, const Spot& b) {
  return a.next_step != b.next_step ? a.next_step > b.next_step : a.id > b.id;
}

}  // namespace

SpotPopulation::SpotPopulation(const SpotParameters& parameters, const Container& container)
    : walk_(parameters, container), next_birth_(walk_.time_before_birth(0)) {}

SpotPopulation::SpotPopulation(const SpotParameters& parameters, const Container& container, ByteReader& saved)
    : walk_(parameters, container) {
  born_ = saved.take<std::int64_t>();
  next_birth_ = saved.take<double>();
  for (auto spots = saved.take<std::uint64_t>(); spots > 0; --spots) spots_.push_back(take_spot(saved));
  std::make_heap(spots_.begin(), spots_.end(), later);
}

void SpotPopulation::save(Bytes& bytes) const {
  append(bytes, born_);
  append(bytes, next_birth_);
  append(bytes, static_cast<std::uint64_t>(spots_.size()));
  for (const Spot& spot : spots_) append(bytes, spot);
}

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
