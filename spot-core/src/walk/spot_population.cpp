// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/walk/spot_population.hpp"

#include <algorithm>
#include <limits>

#include "walk/packed_spot.hpp"

namespace spot {

namespace {

/// Heap order: the spot with the earliest step on top, ties by id.
bool later(const Spot& a, const Spot& b) {
  return a.next_step != b.next_step ? a.next_step > b.next_step : a.id > b.id;
}

}  // namespace

SpotPopulation::SpotPopulation(const SpotParameters& parameters, const Container& container, double diameter)
    : walk_(parameters, container),
      next_birth_(walk_.time_before_birth(0)),
      dilation_(parameters, container, diameter),
      interval_(parameters.dilation > 0.0 ? 0.1 * parameters.radius / parameters.speed : 0.0) {}

SpotPopulation::SpotPopulation(const SpotParameters& parameters, const Container& container, double diameter,
                               ByteReader& saved)
    : SpotPopulation(parameters, container, diameter) {
  born_ = saved.take<std::int64_t>();
  next_birth_ = saved.take<double>();
  for (auto spots = saved.take<std::uint64_t>(); spots > 0; --spots) spots_.push_back(take_spot(saved));
  std::make_heap(spots_.begin(), spots_.end(), later);
  intervals_ = saved.take<std::int64_t>();
  dilation_.restore(saved);
}

void SpotPopulation::save(Bytes& bytes) const {
  append(bytes, born_);
  append(bytes, next_birth_);
  append(bytes, static_cast<std::uint64_t>(spots_.size()));
  for (const Spot& spot : spots_) append(bytes, spot);
  append(bytes, intervals_);
  dilation_.save(bytes);
}

void SpotPopulation::settle() {
  if (in_hand_) std::push_heap(spots_.begin(), spots_.end(), later);
  in_hand_ = false;
}

void SpotPopulation::give_birth(const Container& container) {
  spots_.push_back(walk_.birth(born_, next_birth_, container));
  if (intervals_ > 0) walk_.set_pace(spots_.back(), next_birth_, dilation_.pace(spots_.back().position));
  std::push_heap(spots_.begin(), spots_.end(), later);
  next_birth_ += walk_.time_before_birth(++born_);
}

/// When paces are to be set next.
double SpotPopulation::next_setting() const {
  return interval_ > 0.0 ? static_cast<double>(intervals_) * interval_ : std::numeric_limits<double>::infinity();
}

/// When a spot is born or steps next.
double SpotPopulation::next_event() const {
  return spots_.empty() ? next_birth_ : std::min(next_birth_, spots_.front().next_step);
}

void SpotPopulation::set_paces(double now) {
  std::vector<Vector3> places;
  for (const Spot& spot : spots_) places.push_back(spot.position);
  Alone alone;
  dilation_.count(places, alone);
  for (Spot& spot : spots_) walk_.set_pace(spot, now, dilation_.pace(spot.position));
  std::make_heap(spots_.begin(), spots_.end(), later);
}

std::optional<Move> SpotPopulation::next_move(double time, const Container& container) {
  settle();
  while (true) {
    const double event = next_event();
    if (next_setting() <= std::min(event, time)) {
      set_paces(next_setting());
      ++intervals_;
    } else if (event <= time && event == next_birth_) {
      give_birth(container);
    } else {
      break;
    }
  }
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
