// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/drivers/windowed_drainage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "spot/base/errors.hpp"
#include "spot/base/memory.hpp"
#include "spot/relaxation/calibration.hpp"
#include "spot/relaxation/settling.hpp"
#include "spot/walk/calibration.hpp"

namespace spot {

namespace {

/// In a window spots climb no farther than this, in diameters: coordinates wrap around after 256 of them. And no less
/// than this, or time hardly goes on.
constexpr double highest_climb = 64.0, least_climb = 1e-6;

/// Of one spot, and of all, in a window.
constexpr double most_steps = 1e6, most_births = 1e7;

}  // namespace

double WindowedDrainage::flow_through_orifice(const SpotParameters& spots, double time, double diameter,
                                              const Outlets& outlets) {
  constexpr double packing_fraction = calibration::packing_fraction_of_flow;
  const double radii = spots.equivalent_radius() / diameter;
  const double enclosed = spots.fixed_volume > 0.0 ? spots.fixed_volume * spots.mean_grain_volume
                                                   : 8.0 * packing_fraction * radii * radii * radii;
  double most = 0.0;
  for (std::size_t k = 0; k < outlets.size(); ++k) {
    const double grains = time * spots.injection_rate.largest(k) * spots.influence * enclosed;
    const double orifice = outlets[k].hole->equivalent_radius() / diameter;
    // A grain takes pi / 6 d^3; what passes is a cylinder as wide as the orifice.
    most = std::max(most, grains / (6.0 * packing_fraction * orifice * orifice));
  }
  return most;
}

void WindowedDrainage::require_fitting_window(const SpotParameters& spots) const {
  // Spots that step together carry out in one window what others do in all of the time between steps.
  const double clock = spots.together ? std::max(window_, spots.mean_waiting_time()) : window_;
  const auto require = [&](double value, double most, const char* what) {
    if (!(value <= most))
      throw InvalidParameter(message("in a window of ", clock, ' ', value, ' ', what, ", but at most ", most,
                                     " are allowed: shorten the window"));
  };
  const double climb = clock * (spots.speed / diameter());
  if (!(climb >= least_climb))
    throw InvalidParameter(message("in a window of ", clock, " spots climb ", climb, " diameters, but at least ",
                                   least_climb, " are needed: lengthen the window"));
  const double highest = clock * (spots.fastest() / diameter());
  require(highest, highest_climb, "diameters are climbed by spots");
  require(clock * spots.fastest() / spots.step_height, most_steps, "steps are taken by a spot");
  require(clock * spots.injection_rate.largest(), most_births, "spots are born");
  require(flow_through_orifice(spots, clock, diameter(), container().outlets()), calibration::longest_flow_in_a_window,
          "diameters pass the orifice");
}

double WindowedDrainage::moves_between_sweeps_for(const SpotParameters& spots, double tolerance, double diameter) {
  if (!(tolerance > 0.0) || !std::isfinite(tolerance))
    throw InvalidParameter(message("relaxation tolerance is ", tolerance, " but must be positive and finite"));
  const double displacement = spots.influence * spots.step_width;
  // The steps of a persistent spot add up for some time.
  const double in_a_row = (1.0 + spots.persistence) / (1.0 - spots.persistence);
  const double difference =
      displacement * displacement * in_a_row * spots.profile->mean_square_difference(diameter / spots.radius);
  // Two neighbours that go ways of their own (NonaffineMotion) go on and on: n such moves make n times the difference.
  const double own = spots.nonaffine * spots.influence * spots.step_height;
  const double own_difference = 6.0 * own * own * spots.profile->mean_square_share();
  // The n of which the difference + n of the own difference is this:
  const double most = 3.0 * tolerance * tolerance * diameter * diameter / difference;
  const double moves = 2.0 * most / (1.0 + std::sqrt(1.0 + 4.0 * own_difference / difference * most));
  return std::max(0.1, moves);
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
      moves_between_sweeps_(moves_between_sweeps_for(spots, relaxation.tolerance, spots.mean_diameter(diameter))),
      spots_(spots, Drainage::container(), diameter),
      packing_(diameter, extent, limits.outlet, grains, Drainage::container(), communicator_),
      relaxation_(packing_, relaxation),
      moves_(communicator_) {
  BlockMoves::require_radius(spots.radius, diameter);
  require_fitting_window(spots);
  require_valid_start();
  let_settle(true);
  require_dense_start(*communicator_);
}

void WindowedDrainage::advance_to(double time) {
  // A time that was meant to be a whole number of windows may be off by rounding, but never by a window.
  const double end = time + std::min(1e-12 * time, 0.5 * window_);
  while (static_cast<double>(windows_ + 1) * window_ <= end) {
    const double now = static_cast<double>(windows_) * window_, until = static_cast<double>(++windows_) * window_;
    spots_.set_relative_speeds(now, *communicator_, *workers_);
    spots_.follow_outflow(now, *communicator_);
    spots_.give_birth(until, container(), [this](const Spot& spot) { return here(spot); });
    spots_.update_surface(
        now, [this](const auto& visit, const auto& is_covered) { packing_.cells().visit_uncovered(visit, is_covered); },
        *communicator_);
    step_to(until);
    displace();
    remove_spots_above();
    relax();
    take_out_drained(now, until);
    if (communicator_->size() > 1 && windows_ % calibration::windows_between_balances == 0)
      packing_.balance(container());
  }
}

void WindowedDrainage::step_to(double until) {
  moves_.clear();
  spots_.step_until(until, container(), *workers_,
                    [this](const Spot& spot, const std::vector<Move>& moves) { moves_.add(moves, owner(spot)); });
  if (communicator_->size() == 1) return;
  const auto leaving = spots_.take_out_others([this](const Spot& spot) { return here(spot); });
  spots_.take_in(moves_.share([this](const Move& move) { return reached(move); }, leaving,
                              [this](const Spot& spot) { return owner(spot); }));
}

void WindowedDrainage::displace() {
  displacing_.clear();
  for (const SharedMove& shared : moves_.all()) displacing_.push_back(shared.move);
  packing_.displace(
      displacing_, spot_parameters(), [this](const auto& enclosed, auto& moves) { weigh(enclosed, moves); },
      container(), *workers_);
}

/// `enclosed`: volume of this rank's grains in each move.
void WindowedDrainage::weigh(const std::vector<int>& enclosed, std::vector<Move>& moves) {
  moves_.sum_enclosed(enclosed);
  carry();
  for (std::size_t k = 0; k < moves.size(); ++k) {
    SharedMove& shared = moves_.all()[k];
    if (!moves_.own(shared)) continue;
    shared.move.weight = Drainage::weigh(shared.move, shared.enclosed, carried_[k]);
    spots_.add_to_flow(shared.move, carried_[k].volume);
  }
  spots_.update_flow(window_, *communicator_);
  if (spot_parameters().fixed_volume > 0.0) moves_.send_weights([this](const Move& move) { return reached(move); });
  for (std::size_t k = 0; k < moves.size(); ++k) moves[k].weight = moves_.all()[k].move.weight;
}

/// The moves of a spot follow each other, and one worker does all of them.
void WindowedDrainage::carry() {
  const std::vector<SharedMove>& all = moves_.all();
  carried_.assign(all.size(), {});
  const auto end_of_spot = [&](std::size_t k) {
    while (k > 0 && k < all.size() && all[k].move.spot == all[k - 1].move.spot) ++k;
    return k;
  };
  const auto carry_some = [&](int, std::size_t first, std::size_t last) {
    for (std::size_t k = end_of_spot(first), end = end_of_spot(last); k < end; ++k)
      if (moves_.own(all[k])) carried_[k] = spots_.exchange(all[k].move, all[k].enclosed, container());
  };
  if (container().concurrent())
    workers_->share_out(all.size(), carry_some);
  else
    carry_some(0, 0, all.size());
}

/// Spots that are inside and enclose nothing have come out at the top.
void WindowedDrainage::remove_spots_above() {
  const double inside = container().outlets().height() + spot_parameters().radius;
  for (const SharedMove& shared : moves_.all()) {
    if (!moves_.own(shared)) continue;
    count_move(shared.enclosed);
    if (shared.enclosed == 0 && shared.move.middle.z() > inside) spots_.remove(shared.move.spot);
  }
}

std::size_t WindowedDrainage::memory() const {
  return packing_.memory() + relaxation_.memory() + spots_.memory() + moves_.memory() + bytes_in(displacing_, carried_);
}

/// An outlet at which no spot may be born between these times is closed.
void WindowedDrainage::take_out_drained(double from, double until) {
  const auto is_closed = [&](const Vector3& place) {
    return rates().expected_births(container().nearest_outlet_index(place), from, until) == 0.0;
  };
  std::vector<Grain> drained;
  packing_.take_out_below(limits().outlet, is_closed, drained);
  add_drained(drained, spots_);
  checks().require_left_through_orifice(drained);
}

Counters WindowedDrainage::total() {
  const Counters& own = counters();
  const auto sums = communicator_->sum({own.moves, own.volume_moved, own.volume_left, own.drained});
  return {sums[0], sums[1], own.sweeps, own.grains_swept, sums[2], sums[3]};
}

void WindowedDrainage::relax() {
  double overlap = 0.0;
  for (int sweep = 0; sweep < calibration::most_sweeps_in_a_window; ++sweep) {
    const double deepest = sweep == 0 ? calibration::overlap_relaxed_again : std::numeric_limits<double>::infinity();
    const std::size_t swept = relaxation_.sweep(moves_between_sweeps_, deepest, container(), *workers_);
    if (swept == 0) break;
    count_sweep(swept);
    overlap = std::max(overlap, relaxation_.largest_overlap());
  }
  // Sweeps see no other cells than those that they sweep.
  if (overlap > limits().overlap_allowed() || windows_ % calibration::windows_between_checks == 0)
    checks().require_no_collapse(packing_.largest_overlap());
}

Overlap WindowedDrainage::carry_out(const GrainChanges& changes) {
  const Overlap largest = packing_.change(changes.gone, changes.come, container());
  if (communicator_->least(std::vector<double>{-largest.depth})[0] >= -limits().largest_overlap) let_settle(false);
  return largest;
}

void WindowedDrainage::let_settle(bool everybody) {
  Settling(packing_, spot_parameters().seed, relaxation_parameters().contact_overlap, container(), *workers_)
      .run(everybody);
}

void WindowedDrainage::take_new_container() {
  packing_.require_same_periods(container());
  packing_.mark_near_walls(container());
  spots_.replace_container(container());
}

void WindowedDrainage::take_new_rates(double time, const Injection& rates) {
  SpotParameters spots = spot_parameters();
  spots.injection_rate = rates;
  require_fitting_window(spots);
  spots_.set_rates(time, rates);
}

}  // namespace spot
