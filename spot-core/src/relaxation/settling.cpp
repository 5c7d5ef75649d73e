// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/relaxation/settling.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "packing/kernels.hpp"
#include "packing/wrapped_integers.hpp"
#include "spot/base/random.hpp"
#include "spot/relaxation/support.hpp"

namespace spot {

namespace {

// All in diameters.

/// A grain that touches nobody falls faster and faster, up to so far a sweep; how much less each grain falls is drawn
/// once, so that a lattice comes apart on its way. One that touches others, rolls.
constexpr double longest_fall = 0.25, slower = 0.7, roll = 0.04;

/// In a sweep grains go aside by up to so much: while they fall, and as they roll off places from which they could roll
/// either way.
constexpr double aside_falling = 0.05, aside_rolling = 0.01;

/// Overlap, beyond that in contact, with which a grain is left alone.
constexpr double overlap_at_rest = 0.002;
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

Settling::Settling(TiledPacking& packing, std::uint64_t seed, double in_contact, const Container& container,
                   Workers& workers)
    : packing_(packing),
      cells_(packing.cells()),
      seed_(seed),
      in_contact_(in_contact),
      container_(container),
      workers_(workers),
      diameter_(packing.diameter()),
      bearing_(packing, container),
      falling_(cells_.in_motion) {}

std::size_t Settling::run(bool everybody) {
  if (everybody) {
    packing_.unsupported().clear();
    cells_.visit_own([&](std::uint32_t slot) {
      if (cells_.points[slot].state == Point::free) packing_.unsupported().push_back(cells_.place_of(slot));
    });
  }
  find_hanging();
  const auto left = [this] { return packing_.communicator().sum(static_cast<std::int64_t>(falling_.size())); };
  const std::int64_t settled = left();
  if (settled == 0) return 0;
  for (int number = 0; number < most_sweeps && left() > 0; ++number) {
    sweep(number);
    update();
  }
  press_together();
  return static_cast<std::size_t>(settled);
}

void Settling::update() {
  packing_.ghosts().send_no_positions();
  packing_.update_lists(container_, workers_);
  const auto lies = [this](const Place& place) { return cells_.points[cells_.slot(place)].state == Point::laid; };
  std::copy_if(falling_.begin(), falling_.end(), std::back_inserter(laid_), lies);
  keep(falling_, Point::falling, Point::resting);
}

/// Marks grains that may have lost what bore them as falling, if nobody does, and then those that only they have borne.
void Settling::find_hanging() {
  std::vector<Place>& unsupported = packing_.unsupported();
  std::int64_t found = 0;
  do {
    found = 0;
    while (!unsupported.empty()) {
      const Place place = unsupported.back();
      const std::uint32_t slot = cells_.slot(place);
      unsupported.pop_back();
      if (cells_.points[slot].state != Point::free || !cells_.own(place.cell) || bearing_.is_borne(slot)) continue;
      start_falling(slot);
      packing_.note_unsupported_above(slot);
      ++found;
    }
    found = packing_.communicator().sum(found);
    if (found == 0) break;
    packing_.ghosts().send_no_positions();
    packing_.ghosts().exchange(container_);
    // What falls on the ranks below and above may have borne grains here.
    cells_.visit_ghosts([this](std::uint32_t slot) {
      if (cells_.points[slot].state == Point::falling) packing_.note_unsupported_above(slot);
    });
  } while (found > 0);
}

void Settling::start_falling(std::uint32_t slot) {
  set_state(slot, Point::falling);
  falling_.push_back(cells_.place_of(slot));
}

// ---- how they come down

/// Keeps the places of this rank's grains in these states, once each. Lists may have given grains other slots, or other
/// ranks the grains: whoever occupies a slot with a grain that is not free notes it, so that some are noted twice and
/// others are gone.
void Settling::keep(std::vector<Place>& places, std::int32_t first_state, std::int32_t last_state) const {
  const auto gone = [&](const Place& place) {
    const std::int32_t state = cells_.points[cells_.slot(place)].state;
    return !cells_.own(place.cell) || state < first_state || state > last_state;
  };
  places.erase(std::remove_if(places.begin(), places.end(), gone), places.end());
  std::sort(places.begin(), places.end(),
            [this](const Place& a, const Place& b) { return cells_.slot(a) < cells_.slot(b); });
  const auto same = [this](const Place& a, const Place& b) { return cells_.slot(a) == cells_.slot(b); };
  places.erase(std::unique(places.begin(), places.end(), same), places.end());
}

void Settling::sweep(int number) {
  struct Step {
    Point by;
    std::int32_t state;
  };
  std::vector<Step> steps;
  for (const Place& place : falling_) {
    Step step{};
    step.state = next_state(cells_.slot(place), number, step.by);
    part_from_bearers(cells_.slot(place), step.by);
    steps.push_back(step);
  }
  for (std::size_t k = 0; k < falling_.size(); ++k) move(cells_.slot(falling_[k]), steps[k].by, steps[k].state);
}

/// Pushes a grain that is about to step off those that bear it, until it overlaps them no more.
void Settling::part_from_bearers(std::uint32_t slot, Point& step) const {
  for (int round = 0; round < most_pushes; ++round) {
    Point place = cells_.points[slot];
    add(place, step);
    if (bearing_.push_off(slot, place, in_contact_, step) <= 0.5 * overlap_at_rest) return;
  }
}

/// What becomes of a falling grain; adds to its step what it falls or rolls by.
std::int32_t Settling::next_state(std::uint32_t slot, int sweep, Point& step) const {
  if (sweep + 1 == most_sweeps) return Point::laid;
  Point unused{};
  const double depth = bearing_.push_off(slot, cells_.points[slot], in_contact_, unused);
  const int time_waited = cells_.corrections[slot].state / patience_with_rolls;
  const bool waited = time_waited >= patience;
  const std::vector<Vector3> normals = bearing_.contact_normals(slot, Point::resting);
  const bool on_floor = bearing_.is_on_floor(slot);
  if (waited || on_floor || holds(normals)) {
    // On others that rest, only once these lie still, or all lean on each other.
    const bool still = waited || on_floor || holds(bearing_.contact_normals(slot, Point::laid));
    const bool caught = time_waited >= 2 * patience;  // where there is no room for it
    return caught || (still && depth <= overlap_at_rest) ? Point::laid : Point::resting;
  }
  const auto id = static_cast<std::uint64_t>(cells_.ids[slot]);
  const auto numbers = uniform(seed_, RandomPurpose::settling, id, static_cast<std::uint64_t>(sweep));
  const bool touches = !normals.empty();
  const double last = -cells_.corrections[slot].z * packing_.quantum().length();
  const double fastest = (1.0 - slower * uniform(seed_, RandomPurpose::fall, id, 0)[0]) * longest_fall;
  const double down = touches ? roll * diameter_ : std::clamp(2.0 * last, roll * diameter_, fastest * diameter_);
  const double aside = (touches ? aside_rolling : aside_falling) * diameter_;
  add(step, cells_.lattice().wrapped({aside * (2.0 * numbers[0] - 1.0), aside * (2.0 * numbers[1] - 1.0), -down}));
  return Point::falling;
}

/// The last step of a grain that comes down is kept as its last correction, and in place of a state how long it has
/// waited.
void Settling::move(std::uint32_t slot, const Point& by, std::int32_t state) {
  Point& point = cells_.points[slot];
  add(point, by);
  point.state = state;
  Point& last = cells_.corrections[slot];
  const double down = -by.z * packing_.quantum().length() / diameter_;
  const int waited = std::abs(down) < creeping * roll ? patience_with_rolls : 1;
  last = {by.x, by.y, by.z, down > 2.0 * roll ? 0 : last.state + waited};
  if (state == Point::laid) last = {0, 0, 0, 0};
  cells_.drift.add(cells_.cell_of(slot), length_of(by));
  cells_.note_change(slot);
}

// ---- and press on each other

/// Nobody bore what was still coming down, so that all lie as if each had been put into its place by itself, which is
/// looser than a poured bed. Now they press on each other and on those that they have come to lie on, and all are
/// parted in sweeps as grains are in flow.
void Settling::press_together() {
  falling_.swap(laid_);
  laid_.clear();
  keep(falling_, Point::laid, Point::laid);
  take_along_neighbours();
  for (int sweep = 0; sweep < pressing_sweeps + most_parting_sweeps; ++sweep) {
    const double deepest = part_laid(sweep < pressing_sweeps ? press : 0.0);
    update();
    const double of_all = -packing_.communicator().least(std::vector<double>{-deepest})[0];
    if (sweep >= pressing_sweeps && of_all <= overlap_at_rest) break;
  }
  for (const Place& place : falling_) set_state(cells_.slot(place), Point::free);
  falling_.clear();
  update();
}

/// Each rank finds its own neighbours of all that has come down, here and on the ranks below and above. Those that are
/// on their way out go on.
void Settling::take_along_neighbours() {
  std::vector<std::uint32_t> found;
  const auto find = [&](std::uint32_t slot) {
    for (const std::uint32_t j : packing_.lists().of(slot))
      if (cells_.own(cells_.cell_of(j)) && cells_.points[j].state == Point::free &&
          squared_distance(cells_.points[slot], cells_.points[j]) <=
              square((1.0 + reach_of_pressing) * cells_.touching_distance(slot, j)) &&
          !bearing_.is_over_outlet(cells_.position(j), cells_.radius(j)))
        found.push_back(j);
  };
  for (const Place& place : falling_) find(cells_.slot(place));
  cells_.visit_ghosts([&](std::uint32_t slot) {
    if (cells_.points[slot].state == Point::laid) find(slot);
  });
  for (const std::uint32_t slot : found) falling_.push_back(cells_.place_of(slot));
  for (const Place& place : falling_) set_state(cells_.slot(place), Point::swept);
  keep(falling_, Point::swept, Point::swept);
  packing_.ghosts().send_no_positions();
  packing_.ghosts().exchange(container_);
}

void Settling::set_state(std::uint32_t slot, std::int32_t state) {
  cells_.points[slot].state = state;
  cells_.corrections[slot] = {0, 0, 0, 0};
  cells_.note_change(slot);
}

/// Moves grains down by `down` diameters and off each other. Returns the deepest overlap that they had, in diameters,
/// less that in contact.
double Settling::part_laid(double down) {
  pressed_.count = falling_.size();
  pressed_.slots.clear();
  pressed_.near_walls.clear();
  for (const Place& place : falling_) {
    const auto k = static_cast<std::uint32_t>(pressed_.slots.size());
    pressed_.slots.push_back(cells_.slot(place));
    if (packing_.walls().near_wall(pressed_.slots.back())) pressed_.near_walls.push_back(k);
  }
  pressed_.slots.resize(pressed_.slots.size() + kernels::ahead, 0u);
  find_pushes(packing_, {in_contact_, pair_share, fixed_share}, pressed_);
  add_pushes_of_other_walls(packing_, fixed_share, container_, pressed_);
  double deepest = 0.0;
  for (std::size_t k = 0; k < pressed_.count; ++k) {
    Point& push = pressed_.pushes[k];
    const double depth = 0.5 * static_cast<double>(depth_of(push));
    const double through = bearing_.depth_in_outlet(pressed_.slots[k]);
    deepest = std::max(deepest, depth);
    if (through > 0.0)
      add(push, cells_.lattice().wrapped({0.0, 0.0, fixed_share * through * (2.0 * cells_.radius(pressed_.slots[k]))}));
    else if (depth <= overlap_pressed)
      add(push, cells_.lattice().wrapped({0.0, 0.0, -down * diameter_}));
    move(pressed_.slots[k], push, Point::swept);
  }
  return deepest;
}

}  // namespace spot
