// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/drivers/windowed_drainage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "spot/base/errors.hpp"
#include "spot/base/memory.hpp"
#include "spot/relaxation/settling.hpp"

namespace spot {

namespace {

/// Most sweeps of a cell in one window; what is left over waits for the next.
constexpr int most_sweeps = 16;

/// A cell with an overlap deeper than this, in diameters, is due once more. DEM's deepest is 0.013.
constexpr double deepest_overlap = 0.02;

/// Windows after which all grains are looked at for overlaps, which costs less than 1 % of the run time.
constexpr std::int64_t windows_between_looks = 64;

/// Windows after which ranks see whether layers should be shared out anew. Their spots follow in the next window.
constexpr std::int64_t windows_between_balances = 16;

/// In a window spots climb no farther than this, in diameters: coordinates wrap around after 256 of them. And no less
/// than this, or time hardly goes on.
constexpr double highest_climb = 64.0, least_climb = 1e-6;

/// Of one spot, and of all, in a window.
constexpr double most_steps = 1e6, most_births = 1e7;

/// How far the grains over the orifice go in a window, in diameters, on average: farther, and they pass through the
/// base before they are relaxed.
constexpr double longest_flow = 1.0;

}  // namespace

double WindowedDrainage::flow_through_orifice(const SpotParameters& spots, double time, double diameter,
                                              double orifice_radius) {
  constexpr double packing_fraction = 0.58;
  const double radii = spots.equivalent_radius() / diameter, orifice = orifice_radius / diameter;
  const double enclosed =
      spots.fixed_volume > 0.0 ? spots.fixed_volume : 8.0 * packing_fraction * radii * radii * radii;
  const double grains = time * spots.injection_rate * spots.influence * enclosed;
  // A grain takes pi / 6 d^3; what passes is a cylinder as wide as the orifice.
  return grains / (6.0 * packing_fraction * orifice * orifice);
}

void WindowedDrainage::require_fitting_window() const {
  // Spots that step together carry out in one window what others do in all of the time between steps.
  const double clock = parameters_.together ? std::max(window_, parameters_.mean_waiting_time()) : window_;
  const auto require = [&](double value, double most, const char* what) {
    if (!(value <= most))
      throw InvalidParameter(message("in a window of ", clock, ' ', value, ' ', what, ", but at most ", most,
                                     " are allowed: shorten the window"));
  };
  const double climb = clock * (parameters_.speed / diameter_);
  if (!(climb >= least_climb))
    throw InvalidParameter(message("in a window of ", clock, " spots climb ", climb, " diameters, but at least ",
                                   least_climb, " are needed: lengthen the window"));
  const double highest = clock * (parameters_.fastest() / diameter_);
  require(highest, highest_climb, "diameters are climbed by spots");
  require(clock * parameters_.fastest() / parameters_.step_height, most_steps, "steps are taken by a spot");
  require(clock * parameters_.injection_rate, most_births, "spots are born");
  require(flow_through_orifice(parameters_, clock, diameter_, container().orifice().radius), longest_flow,
          "diameters pass the orifice");
}

double WindowedDrainage::moves_until_due(const SpotParameters& spots, double tolerance, double diameter) {
  if (!(tolerance > 0.0) || !std::isfinite(tolerance))
    throw InvalidParameter(message("relaxation tolerance is ", tolerance, " but must be positive and finite"));
  const double displacement = spots.influence * spots.step_width;
  // The steps of a persistent spot add up for some time.
  const double in_a_row = (1.0 + spots.persistence) / (1.0 - spots.persistence);
  const double difference =
      displacement * displacement * in_a_row * spots.profile->mean_square_difference(diameter / spots.radius);
  return std::max(0.1, 3.0 * tolerance * tolerance * diameter * diameter / difference);
}

double WindowedDrainage::positive_window(double window) {
  if (!(window > 0.0) || !std::isfinite(window))
    throw InvalidParameter(message("window is ", window, " but must be positive and finite"));
  return window;
}

WindowedDrainage::WindowedDrainage(const SpotParameters& spots, const RelaxationParameters& relaxation,
                                   const DrainageLimits& limits, double window, int threads,
                                   std::shared_ptr<const Container> container, double diameter, double extent,
                                   const std::vector<Grain>& grains, std::shared_ptr<Communicator> communicator)
    : Drainage(spots, relaxation, limits, std::move(container), diameter),
      communicator_(std::move(communicator)),
      workers_(std::make_unique<Workers>(threads)),
      window_(positive_window(window)),
      due_(moves_until_due(spots, relaxation.tolerance, diameter)),
      packing_(diameter, extent, limits.outlet, grains, *container_, communicator_),
      relaxation_(packing_, relaxation),
      walk_(spots, *container_),
      dilation_(spots, *container_, diameter) {
  next_birth_ = walk_.time_before_birth(0);
  BlockMoves::require_radius(spots.radius, diameter);
  require_fitting_window();
  require_valid_start();
  let_settle(true);
}

void WindowedDrainage::advance_to(double time) {
  // A time that was meant to be a whole number of windows may be off by rounding, but never by a window.
  const double end = time + std::min(1e-12 * time, 0.5 * window_);
  while (static_cast<double>(windows_ + 1) * window_ <= end) {
    const double now = static_cast<double>(windows_) * window_, until = static_cast<double>(++windows_) * window_;
    set_paces(now);
    give_birth(until);
    walk(until);
    share_turns();
    displace();
    settle();
    relax();
    const std::size_t drained_before = drained_.size();
    packing_.take_out_below(limits_.outlet, drained_);
    counters_.drained += static_cast<std::int64_t>(drained_.size() - drained_before);
    require_left_through_orifice(drained_before);
    if (communicator_->size() > 1 && windows_ % windows_between_balances == 0) packing_.balance(container());
  }
}

/// Where spots are crowded they climb faster, all through a window as at its start.
void WindowedDrainage::set_paces(double now) {
  if (parameters_.dilation == 0.0) return;
  std::vector<Vector3> places;
  for (const Walker& walker : walkers_)
    if (!walker.removed) places.push_back(walker.spot.position);
  dilation_.count(places, *communicator_);
  for (Walker& walker : walkers_)
    if (!walker.removed) walk_.set_pace(walker.spot, now, dilation_.pace(walker.spot.position));
}

/// Every rank sees all births, and keeps its own.
void WindowedDrainage::give_birth(double until) {
  while (next_birth_ <= until) {
    Spot spot = walk_.birth(born_, next_birth_, container());
    if (here(spot.position)) {
      if (parameters_.dilation > 0.0) walk_.set_pace(spot, next_birth_, dilation_.pace(spot.position));
      walkers_.push_back({spot, false});
    }
    next_birth_ += walk_.time_before_birth(++born_);
  }
}

void WindowedDrainage::walk(double until) {
  turns_.clear();
  for (Walker& walker : walkers_) {
    if (walker.removed) continue;
    const std::size_t first = turns_.size();
    while (walker.spot.next_step <= until)
      turns_.push_back({walk_.step(walker.spot, container()), communicator_->rank(), 0});
    for (std::size_t k = first; k < turns_.size(); ++k) turns_[k].owner = packing_.owner(walker.spot.position.z());
  }
}

void WindowedDrainage::displace() {
  moves_.clear();
  for (const Turn& turn : turns_) moves_.push_back(turn.move);
  packing_.displace(
      moves_, parameters_, [this](const auto& shares, auto& moves) { weigh(shares, moves); }, container(), *workers_,
      received());
}

/// `shares`: of this rank's grains.
void WindowedDrainage::weigh(const std::vector<int>& shares, std::vector<Move>& moves) {
  for (std::size_t k = 0; k < turns_.size(); ++k) turns_[k].shares = shares[k];
  gather_shares();
  for (Turn& turn : turns_)
    turn.move.weight = fixed_volume_weight(parameters_, turn.move.middle.z() - limits_.outlet, turn.shares);
  if (parameters_.fixed_volume > 0.0) send_weights();
  for (std::size_t k = 0; k < turns_.size(); ++k) moves[k].weight = turns_[k].move.weight;
}

/// What moves tell their spots: that there is nothing left above.
void WindowedDrainage::settle() {
  const double inside = container().orifice().centre.z() + parameters_.radius;
  auto walker = walkers_.begin();
  for (const Turn& turn : turns_) {
    if (turn.owner != communicator_->rank()) continue;
    ++counters_.moves;
    counters_.shares_moved += turn.shares;
    while (walker->spot.id < turn.move.spot) ++walker;
    if (turn.shares > 0 || turn.move.middle.z() <= inside || walker->removed) continue;
    walker->removed = true;
    ++removed_;
  }
  if (removed_ > walkers_.size() / 16) drop_removed();
}

void WindowedDrainage::drop_removed() {
  const auto end =
      std::remove_if(walkers_.begin(), walkers_.end(), [](const Walker& walker) { return walker.removed; });
  walkers_.erase(end, walkers_.end());
  removed_ = 0;
}

std::vector<Spot> WindowedDrainage::spots() const {
  std::vector<Spot> live;
  for (const Walker& walker : walkers_)
    if (!walker.removed) live.push_back(walker.spot);
  return live;
}

std::size_t WindowedDrainage::memory() const {
  return packing_.memory() + relaxation_.memory() + dilation_.memory() + bytes_in(walkers_, turns_, moves_);
}

void WindowedDrainage::relax() {
  double overlap = 0.0;
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    // Once a window only: a cell that is swept over and over on its own is pushed into its neighbours.
    const double deepest = sweep == 0 ? deepest_overlap : std::numeric_limits<double>::infinity();
    const std::size_t swept = relaxation_.sweep(due_, deepest, container(), *workers_);
    if (swept == 0) break;
    ++counters_.sweeps;
    counters_.grains_swept += static_cast<std::int64_t>(swept);
    overlap = std::max(overlap, relaxation_.largest_overlap());
  }
  // Sweeps do not see cells that are not due.
  if (overlap > overlap_allowed() || windows_ % windows_between_looks == 0)
    require_no_collapse(packing_.largest_overlap());
}

Overlap WindowedDrainage::carry_out(const GrainChanges& changes) {
  const Overlap largest = packing_.change(changes.gone, changes.come, container());
  if (communicator_->least(std::vector<double>{-largest.depth})[0] >= -limits_.largest_overlap) let_settle(false);
  return largest;
}

void WindowedDrainage::let_settle(bool everybody) {
  Settling(packing_, parameters_.seed, relaxation_parameters_.contact_overlap, container(), *workers_).run(everybody);
}

void WindowedDrainage::replace_container(std::shared_ptr<const Container> container) {
  container_ = std::move(container);
  packing_.mark_near_walls(*container_);
  dilation_.replace_container(*container_);
}

}  // namespace spot
