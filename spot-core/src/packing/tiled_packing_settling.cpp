// SPDX-License-Identifier: GPL-2.0-or-later
// Grains that nothing holds come down until contacts do.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "packing/kernels.hpp"
#include "packing/wrapped_integers.hpp"
#include "spot/base/random.hpp"
#include "spot/packing/support.hpp"
#include "spot/packing/tiled_packing.hpp"

namespace spot {

namespace {

// All in diameters.

/// A grain of the packing hangs if it finds nobody lower than itself by the second, no farther away than the first.
constexpr double reach_of_support = 1.5, least_drop = 0.25;

/// Walls bear a grain from so far away, if their normal points upwards by the second; by the third, they are a floor.
constexpr double wall_reach = 1.0, least_upwards = 0.1, flat = 0.99;

/// A grain that touches nobody falls faster and faster, up to so far a sweep; how much less each grain falls is drawn
/// once, so that a lattice comes apart on its way. One that touches others, rolls.
constexpr double longest_fall = 0.25, slower = 0.7, roll = 0.04;

/// In a sweep grains go aside by up to so much: while they fall, and as they roll off places from which they could roll
/// either way.
constexpr double drift = 0.05, jitter = 0.01;

/// Gap at which two grains bear on each other, and overlap, beyond that in contact, with which one is left alone.
constexpr double contact_gap = 0.01, overlap_at_rest = 0.002;

/// Of an overlap, what a grain goes off one that bears it, or off a wall.
constexpr double strength = 0.5;
constexpr int most_pushes = 8;

/// A grain that comes down by less than this share of a roll creeps. It has come to rest after so many sweeps of that,
/// as grains do that lean on each other, or so many times as many of any that do not end in a free fall.
constexpr double creeping = 0.1;
constexpr int patience = 512, patience_with_rolls = 8;

/// Sweeps after which even the last grain lies where it is; and to part those that lie.
constexpr int most_sweeps = 20000, most_parting_sweeps = 2000;

/// How far grains go down in a sweep while they press on each other, for how many sweeps, and how near grains are that
/// bear some of it. It takes half a diameter to make a bed as dense as one that is poured.
constexpr double press = 0.01, reach_of_pressing = 0.5;
constexpr int pressing_sweeps = 50;

/// Grains that overlap others by more press on nobody else.
constexpr double overlap_pressed = 0.01;

/// Of an overlap, what each of two grains that lie goes, and one against any other grain.
constexpr float pair_share = 0.4f, fixed_share = 0.8f;

}  // namespace

std::size_t TiledPacking::settle(bool everybody, std::uint64_t seed, double in_contact, const Container& container,
                                 Workers& workers) {
  if (everybody) {
    loosened_.clear();
    for (std::uint32_t slot = first_owned() * capacity_; slot < last_owned() * capacity_; ++slot)
      if (points_[slot].state == Point::free) loosened_.push_back({slot / capacity_, slot % capacity_});
  }
  find_hanging(container);
  const std::int64_t settled = communicator_->sum(static_cast<std::int64_t>(falling_.size()));
  if (settled == 0) return 0;
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    if (communicator_->sum(static_cast<std::int64_t>(falling_.size())) == 0) break;
    sweep_falling({seed, sweep, in_contact, sweep + 1 == most_sweeps}, container);
    update_falling(container, workers);
  }
  press_together(in_contact, container, workers);
  return static_cast<std::size_t>(settled);
}

void TiledPacking::update_falling(const Container& container, Workers& workers) {
  choose_sent(no_cell);
  update_lists(container, workers);
  const auto lies = [this](const Place& place) { return points_[slot(place)].state == Point::laid; };
  std::copy_if(falling_.begin(), falling_.end(), std::back_inserter(laid_), lies);
  keep(falling_, Point::falling, Point::resting);
}

// ---- who hangs

/// Marks those of `loosened_` that nobody bears as falling, and then those that only they have borne.
void TiledPacking::find_hanging(const Container& container) {
  std::int64_t found = 0;
  do {
    found = 0;
    while (!loosened_.empty()) {
      const std::uint32_t at = slot(loosened_.back());
      loosened_.pop_back();
      if (points_[at].state != Point::free || !owned(at / capacity_) || is_borne(at, container)) continue;
      start_falling(at);
      note_neighbours_above(at);
      ++found;
    }
    found = communicator_->sum(found);
    if (found == 0) break;
    choose_sent(no_cell);
    exchange_border(container);
    note_above_falling_copies();
  } while (found > 0);
}

bool TiledPacking::is_borne(std::uint32_t at, const Container& container) const {
  const double per_diameter = quantum_.length() / diameter_;
  const std::uint32_t* list = lists_.data() + static_cast<std::size_t>(at) * list_capacity_;
  for (std::uint32_t k = 0; k < list_size_[at]; ++k) {
    const Point& other = points_[list[k]];
    if (other.state == Point::falling) continue;
    if (minus(points_[at].z, other.z) * per_diameter < least_drop) continue;
    if (squared_distance(points_[at], other) * square(per_diameter) <= square(reach_of_support)) return true;
  }
  return stands_on_orifice(position(at), wall_reach, container) || stands_on_wall(position(at), container);
}

/// The packing over the orifice is borne by what flows out of it, which is the spots' business.
bool TiledPacking::stands_on_orifice(const Vector3& at, double reach, const Container& container) const {
  const Orifice& orifice = container.orifice();
  const double height = at.z() - orifice.centre.z();
  return height < 0.0 || (height <= reach * diameter_ && (at - orifice.centre).head<2>().norm() <= orifice.radius);
}

bool TiledPacking::stands_on_wall(const Vector3& at, const Container& container) const {
  WallContacts contacts;
  container.contacts(at, wall_reach * diameter_, contacts);
  return std::any_of(contacts.begin(), contacts.end(),
                     [](const WallContact& contact) { return contact.normal.z() >= least_upwards; });
}

void TiledPacking::start_falling(std::uint32_t at) {
  points_[at].state = Point::falling;
  momenta_[at] = {0, 0, 0, 0};
  note_change(at);
  falling_.push_back({at / capacity_, at % capacity_});
}

void TiledPacking::note_neighbours_above(std::uint32_t at) {
  const std::uint32_t* list = lists_.data() + static_cast<std::size_t>(at) * list_capacity_;
  for (std::uint32_t k = 0; k < list_size_[at]; ++k)
    if (points_[list[k]].state == Point::free && minus(points_[list[k]].z, points_[at].z) > 0)
      loosened_.push_back({list[k] / capacity_, list[k] % capacity_});
}

/// What falls on the ranks below and above may have borne grains here.
void TiledPacking::note_above_falling_copies() {
  visit_copies([this](std::uint32_t at) {
    if (points_[at].state == Point::falling) note_neighbours_above(at);
  });
}

template <typename Visit>
void TiledPacking::visit_copies(const Visit& visit) const {
  for (std::uint32_t slot = 0; slot < first_owned() * capacity_; ++slot) visit(slot);
  for (std::uint32_t slot = last_owned() * capacity_; slot < cells() * capacity_; ++slot) visit(slot);
}

// ---- how they come down

/// Keeps the places of this rank's grains in these states, once each. Lists may have given grains other slots, or other
/// ranks the grains: whoever occupies a slot with a grain that is not free notes it, so that some are noted twice and
/// others are gone.
void TiledPacking::keep(std::vector<Place>& places, std::int32_t first_state, std::int32_t last_state) const {
  const auto gone = [&](const Place& place) {
    const std::int32_t state = points_[slot(place)].state;
    return !owned(place.cell) || state < first_state || state > last_state;
  };
  places.erase(std::remove_if(places.begin(), places.end(), gone), places.end());
  std::sort(places.begin(), places.end(), [this](const Place& a, const Place& b) { return slot(a) < slot(b); });
  const auto same = [this](const Place& a, const Place& b) { return slot(a) == slot(b); };
  places.erase(std::unique(places.begin(), places.end(), same), places.end());
}

/// All grains decide by where all were before, and how they were.
void TiledPacking::sweep_falling(const Settling& settling, const Container& container) {
  struct Step {
    Point by;
    std::int32_t state;
  };
  std::vector<Step> steps;
  for (const Place& place : falling_) {
    Step step{};
    step.state = next_state(slot(place), step.by, settling, container);
    part_from_bearers(slot(place), step.by, settling.in_contact, container);
    steps.push_back(step);
  }
  for (std::size_t k = 0; k < falling_.size(); ++k) move_falling(slot(falling_[k]), steps[k].by, steps[k].state);
}

/// A grain is pushed off those that are not themselves coming down from above it: nobody has to bear what still falls,
/// or grains at the bottom of a heap would be pressed into each other. Returns the deepest of the overlaps, in
/// diameters, less that in contact.
double TiledPacking::push_off_bearers(std::uint32_t at, const Point& place, double in_contact,
                                      const Container& container, Point& push) const {
  const double parted = (1.0 - in_contact) * diameter_ / quantum_.length();
  double least = square(parted);
  const std::uint32_t* list = lists_.data() + static_cast<std::size_t>(at) * list_capacity_;
  for (std::uint32_t k = 0; k < list_size_[at]; ++k) {
    const Point& other = points_[list[k]];
    const double squared = squared_distance(place, other);
    if (squared >= square(parted)) continue;
    const Point by = minus(place, other);
    const bool comes_down = other.state == Point::falling || other.state == Point::resting;
    if (comes_down && (by.z < 0 || (by.z == 0 && ids_[at] < ids_[list[k]]))) continue;
    least = std::min(least, squared);
    // Centres that coincide have no line between them.
    const double scale = squared > 0.0 ? strength * (parted / std::sqrt(squared) - 1.0) : 0.0;
    push.x = add(push.x, wrap(std::llrint(scale * by.x)));
    push.y = add(push.y, wrap(std::llrint(scale * by.y)));
    push.z = add(push.z, squared > 0.0 ? wrap(std::llrint(scale * by.z)) : wrap(std::llrint(strength * parted)));
  }
  double depth = 1.0 - std::sqrt(least) / parted;
  WallContacts walls;
  if (near_wall_[at] != 0) container.contacts(low_ + from_low(place, at / capacity_), 0.5 * diameter_, walls);
  for (const WallContact& wall : walls) {
    const double overlap = 0.5 * diameter_ - wall.distance;
    this->push(push, strength * overlap * wall.normal);
    depth = std::max(depth, overlap / diameter_);
  }
  return depth;
}

/// Pushes a grain that is about to step off those that bear it, until it overlaps them no more.
void TiledPacking::part_from_bearers(std::uint32_t at, Point& step, double in_contact,
                                     const Container& container) const {
  for (int round = 0; round < most_pushes; ++round) {
    const Point& from = points_[at];
    const Point place = {add(from.x, step.x), add(from.y, step.y), add(from.z, step.z), from.state};
    if (push_off_bearers(at, place, in_contact, container, step) <= 0.5 * overlap_at_rest) return;
  }
}

/// What becomes of a falling grain; adds to its step what it falls or rolls by.
std::int32_t TiledPacking::next_state(std::uint32_t at, Point& step, const Settling& settling,
                                      const Container& container) const {
  if (settling.last) return Point::laid;
  Point unused{};
  const double depth = push_off_bearers(at, points_[at], settling.in_contact, container, unused);
  const auto id = static_cast<std::uint64_t>(ids_[at]), sweep = static_cast<std::uint64_t>(settling.sweep);
  const auto numbers = uniform(settling.seed, RandomPurpose::settling, id, sweep);
  const int time_waited = momenta_[at].state / patience_with_rolls;
  const bool waited = time_waited >= patience;
  const std::vector<Vector3> normals = normals_of_contacts(at, Point::resting, container);
  const bool on_floor = lies_on_floor(at, container);
  if (waited || on_floor || holds(normals)) {
    // On others that rest, only once these lie still, or all lean on each other.
    const bool still = waited || on_floor || holds(normals_of_contacts(at, Point::laid, container));
    const bool caught = time_waited >= 2 * patience;  // where there is no room for it
    return caught || (still && depth <= overlap_at_rest) ? Point::laid : Point::resting;
  }
  const bool touches = !normals.empty();
  const double last = -momenta_[at].z * quantum_.length();
  const double fastest = (1.0 - slower * uniform(settling.seed, RandomPurpose::fall, id, 0)[0]) * longest_fall;
  const double down = touches ? roll * diameter_ : std::clamp(2.0 * last, roll * diameter_, fastest * diameter_);
  const double aside = (touches ? jitter : drift) * diameter_;
  push(step, {aside * (2.0 * numbers[0] - 1.0), aside * (2.0 * numbers[1] - 1.0), -down});
  return Point::falling;
}

bool TiledPacking::lies_on_floor(std::uint32_t at, const Container& container) const {
  if (stands_on_orifice(position(at), 0.5, container)) return true;
  WallContacts walls;
  if (near_wall_[at] != 0) container.contacts(position(at), (0.5 + contact_gap) * diameter_, walls);
  return std::any_of(walls.begin(), walls.end(), [](const WallContact& wall) { return wall.normal.z() > flat; });
}

/// From everything that a grain touches to the grain; of grains that come down, those that are `least` at rest.
std::vector<Vector3> TiledPacking::normals_of_contacts(std::uint32_t at, std::int32_t least,
                                                       const Container& container) const {
  std::vector<Vector3> normals;
  const double reach = (1.0 + contact_gap) * diameter_ / quantum_.length();
  const std::uint32_t* list = lists_.data() + static_cast<std::size_t>(at) * list_capacity_;
  for (std::uint32_t k = 0; k < list_size_[at]; ++k) {
    const Point& other = points_[list[k]];
    const bool bears = other.state != Point::falling && (other.state != Point::resting || least == Point::resting);
    if (!bears || squared_distance(points_[at], other) > square(reach)) continue;
    const Point by = minus(points_[at], other);
    const Vector3 normal = Vector3(by.x, by.y, by.z);
    if (normal.squaredNorm() > 0.0) normals.push_back(normal.normalized());
  }
  WallContacts walls;
  if (near_wall_[at] != 0) container.contacts(position(at), (0.5 + contact_gap) * diameter_, walls);
  for (const WallContact& wall : walls) normals.push_back(wall.normal);
  return normals;
}

void TiledPacking::move_falling(std::uint32_t at, const Point& by, std::int32_t state) {
  Point& point = points_[at];
  point = {add(point.x, by.x), add(point.y, by.y), add(point.z, by.z), state};
  Point& last = momenta_[at];
  const double down = -by.z * quantum_.length() / diameter_;
  const int waited = std::abs(down) < creeping * roll ? patience_with_rolls : 1;
  last = {by.x, by.y, by.z, down > 2.0 * roll ? 0 : last.state + waited};
  if (state == Point::laid) last = {0, 0, 0, 0};
  std::int32_t& path = path_[at / capacity_];
  path = static_cast<std::int32_t>(std::min<std::int64_t>(static_cast<std::int64_t>(path) + length_of(by), 1 << 30));
  note_change(at);
}

/// Nobody bore what was still coming down, so that all lie as if each had been put into its place by itself, which is
/// looser than a poured bed. Now they press on each other and on those that they have come to lie on, and all are
/// parted in sweeps as grains are in flow.
void TiledPacking::press_together(double in_contact, const Container& container, Workers& workers) {
  falling_.swap(laid_);
  laid_.clear();
  keep(falling_, Point::laid, Point::laid);
  take_along_neighbours(container);
  for (int sweep = 0; sweep < pressing_sweeps + most_parting_sweeps; ++sweep) {
    const double deepest = part_laid(in_contact, sweep < pressing_sweeps ? press : 0.0, container);
    update_falling(container, workers);
    const double of_all = -communicator_->least(std::vector<double>{-deepest})[0];
    if (sweep >= pressing_sweeps && of_all <= overlap_at_rest) break;
  }
  for (const Place& place : falling_) set_state(slot(place), Point::free);
  falling_.clear();
  update_falling(container, workers);
}

/// Each rank finds its own neighbours of all that has come down, here and on the ranks below and above. Those that are
/// on their way out go on.
void TiledPacking::take_along_neighbours(const Container& container) {
  const double reach = square((1.0 + reach_of_pressing) * diameter_ / quantum_.length());
  std::vector<std::uint32_t> found;
  const auto find = [&](std::uint32_t at) {
    const std::uint32_t* list = list_of(at);
    for (std::uint32_t k = 0; k < list_size_[at]; ++k)
      if (owned(list[k] / capacity_) && points_[list[k]].state == Point::free &&
          squared_distance(points_[at], points_[list[k]]) <= reach &&
          !stands_on_orifice(position(list[k]), 0.5, container))
        found.push_back(list[k]);
  };
  for (const Place& place : falling_) find(slot(place));
  visit_copies([&](std::uint32_t at) {
    if (points_[at].state == Point::laid) find(at);
  });
  for (const std::uint32_t at : found) falling_.push_back({at / capacity_, at % capacity_});
  for (const Place& place : falling_) set_state(slot(place), Point::due);
  keep(falling_, Point::due, Point::due);
  choose_sent(no_cell);
  exchange_border(container);
}

/// How deep a grain has sunk into the orifice, which is a floor until spots come, in diameters.
double TiledPacking::depth_in_orifice(const Vector3& at, const Container& container) const {
  const double height = (at.z() - container.orifice().centre.z()) / diameter_;
  return height >= 0.0 && stands_on_orifice(at, 0.5, container) ? 0.5 - height : 0.0;
}

void TiledPacking::set_state(std::uint32_t at, std::int32_t state) {
  points_[at].state = state;
  momenta_[at] = {0, 0, 0, 0};
  note_change(at);
}

/// Moves grains down by `down` diameters and off each other. Returns the deepest overlap that they had, in diameters,
/// less that in contact.
double TiledPacking::part_laid(double in_contact, double down, const Container& container) {
  Task task;
  for (const Place& place : falling_) task.active.push_back(slot(place));
  task.grains = static_cast<std::uint32_t>(falling_.size());
  for (std::uint32_t k = 0; k < task.grains; ++k)
    if (near_wall_[task.active[k]] != 0) task.walled.push_back(k);
  task.active.resize(task.active.size() + kernels::ahead, 0u);
  task.pushes.resize(task.grains);
  const double parted = (1.0 - in_contact) * diameter_ / quantum_.length();
  kernels_->push_off_neighbours(
      points_.data(), task.active.data(), task.grains, {lists_.data(), list_size_.data(), list_capacity_},
      {static_cast<float>(1.0 / square(parted)), pair_share, fixed_share}, task.pushes.data());
  part_coincident(task, pair_share * diameter_);
  push_off_planes(task, fixed_share);
  push_off_other_walls(task, fixed_share, container);
  double deepest = 0.0;
  for (std::uint32_t k = 0; k < task.grains; ++k) {
    const std::uint32_t at = task.active[k];
    const double depth = 0.5 * static_cast<double>(depth_of(task.pushes[k]));
    const double through = depth_in_orifice(position(at), container);
    deepest = std::max(deepest, depth);
    if (through > 0.0)
      push(task.pushes[k], {0.0, 0.0, fixed_share * through * diameter_});
    else if (depth <= overlap_pressed)
      push(task.pushes[k], {0.0, 0.0, -down * diameter_});
    move_falling(at, task.pushes[k], Point::due);
  }
  return deepest;
}

}  // namespace spot
