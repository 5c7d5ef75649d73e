// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/walk/spots.hpp"

#include <algorithm>
#include <limits>

#include "spot/base/memory.hpp"
#include "spot/walk/calibration.hpp"
#include "walk/packed_spot.hpp"

namespace spot {

Spots::Spots(const SpotParameters& parameters, const Container& container, double diameter)
    : walk_(parameters, container),
      outflow_(parameters, container, diameter),
      dilates_(parameters.dilation > 0.0),
      dilation_(parameters, container, diameter),
      critical_(parameters, diameter),
      shears_(parameters.dilatancy > 0.0 || parameters.full_strain > 0.0 || parameters.spread > 0.0),
      flow_(parameters, container, diameter),
      surface_(parameters, container, diameter),
      surfaces_(calibration::climb_between_surfaces * parameters.radius / parameters.speed),
      setting_interval_(dilates_ || shears_ || surface_.needed() || outflow_.on()
                            ? calibration::climb_between_settings * parameters.radius / parameters.speed
                            : 0.0) {
  await_birth(0.0);
}

void Spots::await_birth(double from) {
  next_birth_.await(from, walk_.births_expected(born_), outflow_.births(), outflow_.factors());
}

/// Returns whether the newborn spot was kept.
bool Spots::bear_next(const Container& container, const Belongs& here) {
  const double now = next_birth_.time();
  Spot spot = walk_.birth(born_, now, container);
  const bool kept = here(spot);
  if (kept) {
    if (dilates_) walk_.set_relative_speed(spot, now, dilation_.relative_speed(spot.position));
    places_.push_back({spot, false});
  }
  ++born_;
  await_birth(now);
  return kept;
}

void Spots::give_birth(double until, const Container& container, const Belongs& here) {
  while (next_birth_.time() <= until) bear_next(container, here);
}

void Spots::set_relative_speeds(double now, Communicator& communicator, Workers& workers) {
  if (!dilates_) return;
  std::vector<Vector3> positions;
  for (const Place& place : places_)
    if (!place.removed) positions.push_back(place.spot.position);
  dilation_.count(positions, communicator, workers);
  workers.share_out(places_.size(), [&](int, std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      Spot& spot = places_[k].spot;
      if (!places_[k].removed) walk_.set_relative_speed(spot, now, dilation_.relative_speed(spot.position));
    }
  });
  queued_ = false;
}

void Spots::step_until(double until, const Container& container, Workers& workers,
                       const std::function<void(const Spot&, const std::vector<Move>&)>& visit) {
  stepped_.assign(static_cast<std::size_t>(workers.size()), {});
  const auto step = [&](int worker, std::size_t first, std::size_t last) {
    Stepped& stepped = stepped_[static_cast<std::size_t>(worker)];
    for (std::size_t k = first; k < last; ++k) {
      Spot& spot = places_[k].spot;
      if (places_[k].removed || !(spot.next_step <= until)) continue;
      const std::size_t before = stepped.moves.size();
      while (spot.next_step <= until)
        if (stands(spot))
          walk_.wait(spot);
        else
          stepped.moves.push_back(walk_.step(spot, container, surface_, flow_));
      if (stepped.moves.size() > before) stepped.ends.push_back({k, stepped.moves.size()});
    }
  };
  if (container.concurrent())
    workers.share_out(places_.size(), step);
  else
    step(0, 0, places_.size());
  for (const Stepped& stepped : stepped_) {
    auto first = stepped.moves.begin();
    for (const auto& [place, moves] : stepped.ends) {
      const auto last = stepped.moves.begin() + static_cast<std::ptrdiff_t>(moves);
      visit(places_[place].spot, {first, last});
      first = last;
    }
  }
  queued_ = false;
}

/// A gate stops the flow above it at once, as DEM's does: what free volume is on its way waits there until it opens.
bool Spots::stands(const Spot& spot) const {
  return rates().at(static_cast<std::size_t>(spot.outlet), spot.next_step) == 0.0;
}

void Spots::queue(std::size_t place) {
  events_.push_back({places_[place].spot.next_step, places_[place].spot.id, place});
  std::push_heap(events_.begin(), events_.end());
}

void Spots::queue_all() {
  events_.clear();
  for (std::size_t k = 0; k < places_.size(); ++k)
    if (!places_[k].removed) events_.push_back({places_[k].spot.next_step, places_[k].spot.id, k});
  std::make_heap(events_.begin(), events_.end());
  queued_ = true;
}

void Spots::drop_removed_events() {
  while (!events_.empty() && places_[events_.front().place].removed) {
    std::pop_heap(events_.begin(), events_.end());
    events_.pop_back();
  }
}

/// When relative speeds are to be set next.
double Spots::next_setting() const {
  return setting_interval_ > 0.0 ? static_cast<double>(settings_) * setting_interval_
                                 : std::numeric_limits<double>::infinity();
}

std::optional<Move> Spots::next_step(double time, const Container& container, const VisitGrains& visit_grains) {
  while (true) {
    if (!queued_) queue_all();
    drop_removed_events();
    const double event = events_.empty() ? next_birth_.time() : std::min(next_birth_.time(), events_.front().time);
    if (next_setting() <= std::min(event, time)) {
      Alone alone;
      Workers one_thread(1);
      set_relative_speeds(next_setting(), alone, one_thread);
      if (settings_ > 0) update_flow(setting_interval_, alone);
      update_surface(next_setting(), visit_grains, alone);
      follow_outflow(next_setting(), alone);
      ++settings_;
    } else if (event <= time && event == next_birth_.time()) {
      bear_next(container, [](const Spot&) { return true; });
      queue(places_.size() - 1);
    } else if (events_.empty() || events_.front().time > time) {
      return std::nullopt;
    } else {
      std::pop_heap(events_.begin(), events_.end());
      const std::size_t place = events_.back().place;
      events_.pop_back();
      Spot& spot = places_[place].spot;
      std::optional<Move> move;
      if (stands(spot))
        walk_.wait(spot);
      else
        move = walk_.step(spot, container, surface_, flow_);
      queue(place);
      if (move) return move;
    }
  }
}

/// places_.end() if it is gone.
std::vector<Spots::Place>::iterator Spots::find(std::int64_t spot) {
  const auto place = std::lower_bound(places_.begin(), places_.end(), spot,
                                      [](const Place& a, std::int64_t id) { return a.spot.id < id; });
  return place == places_.end() || place->spot.id != spot || place->removed ? places_.end() : place;
}

Spots::Carried Spots::carry(const Move& move, int enclosed, const Container& container) {
  const Carried carried = exchange(move, enclosed, container);
  if (shears_ && find(move.spot) != places_.end()) add_to_flow(move, carried.volume);
  return carried;
}

Spots::Carried Spots::exchange(const Move& move, int enclosed, const Container& container) {
  Carried carried;
  const auto place = critical_.on() ? find(move.spot) : places_.end();
  if (place == places_.end()) return carried;
  carried.volume = place->spot.volume;
  const Strain strain = shears_ ? flow_.strain(move.middle) : Strain();
  place->spot.volume = critical_.volume_after(carried.volume, move, enclosed, strain, container);
  carried.left = static_cast<std::int64_t>((carried.volume - place->spot.volume) * CriticalState::volume_parts);
  return carried;
}

void Spots::update_flow(double elapsed, Communicator& communicator) {
  if (shears_) flow_.update(elapsed, communicator);
}

void Spots::update_surface(double now, const VisitGrains& visit_grains, Communicator& communicator) {
  if (!surface_.needed() || !surfaces_.due(now)) return;
  surface_.clear();
  visit_grains([this](const Vector3& position) { surface_.add(position); },
               [this](const Vector3& low, const Vector3& high) { return surface_.covers(low, high); });
  surface_.gather(communicator);
}

void Spots::follow_outflow(double now, Communicator& communicator) {
  if (!outflow_.update(now, communicator)) return;
  outflow_.fade(surface_);
  walk_.set_rates(outflow_.rates());
}

void Spots::set_rates(double now, const Injection& rates) {
  next_birth_.change(now, outflow_.births(), rates);
  outflow_.change(now, rates);
  walk_.set_rates(outflow_.rates());
}

void Spots::replace_container(const Container& container) {
  dilation_.replace_container(container);
  flow_.replace_container(container);
  surface_.replace_container(container);
}

void Spots::remove(std::int64_t spot) {
  const auto place = find(spot);
  if (place == places_.end()) return;
  place->removed = true;
  if (++removed_ > places_.size() / 16) close_gaps();
}

void Spots::close_gaps() {
  places_.erase(std::remove_if(places_.begin(), places_.end(), [](const Place& place) { return place.removed; }),
                places_.end());
  removed_ = 0;
  queued_ = false;
}

std::vector<Spot> Spots::take_out_others(const Belongs& here) {
  std::vector<Spot> others;
  for (Place& place : places_) {
    if (place.removed || here(place.spot)) continue;
    others.push_back(place.spot);
    place.removed = true;
  }
  close_gaps();
  return others;
}

void Spots::take_in(const std::vector<Spot>& spots) {
  if (spots.empty()) return;
  for (const Spot& spot : spots) places_.push_back({spot, false});
  std::sort(places_.begin(), places_.end(), [](const Place& a, const Place& b) { return a.spot.id < b.spot.id; });
  queued_ = false;
}

std::vector<Spot> Spots::live() const {
  std::vector<Spot> spots;
  for (const Place& place : places_)
    if (!place.removed) spots.push_back(place.spot);
  return spots;
}

void Spots::save(Bytes& bytes) const {
  append(bytes, born_);
  next_birth_.save(bytes);
  append(bytes, live());
  append(bytes, settings_);
  surfaces_.save(bytes);
  dilation_.save(bytes);
  flow_.save(bytes);
  surface_.save(bytes);
  outflow_.save(bytes);
}

void Spots::restore(ByteReader& saved, bool counts) {
  born_ = saved.take<std::int64_t>();
  next_birth_.restore(saved);
  take_in(take_spots(saved));
  settings_ = saved.take<std::int64_t>();
  surfaces_.restore(saved);
  dilation_.restore(saved);
  flow_.restore(saved);
  surface_.restore(saved);
  outflow_.restore(saved, counts);
  walk_.set_rates(outflow_.rates());
}

std::size_t Spots::memory() const {
  return bytes_in(places_, events_) + dilation_.memory() + flow_.memory() + surface_.memory();
}

}  // namespace spot
