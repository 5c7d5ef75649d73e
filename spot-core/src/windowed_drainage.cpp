// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/windowed_drainage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "spot/errors.hpp"

namespace spot {

namespace {

/// Most sweeps of a cell in one window; what is left over waits for the next.
constexpr int most_sweeps = 16;

/// A cell with an overlap deeper than this, in diameters, is due once more. DEM's deepest is 0.013.
constexpr double deepest_overlap = 0.02;

constexpr double removed = std::numeric_limits<double>::infinity();

double moves_until_due(const SpotParameters& spots, double tolerance) {
  if (!(tolerance > 0.0) || !std::isfinite(tolerance))
    throw InvalidParameter(message("relaxation tolerance is ", tolerance, " but must be positive and finite"));
  const double displacement = spots.influence * spots.step_width;
  return std::max(0.1, 12.0 * tolerance * tolerance / (displacement * displacement));
}

double positive_window(double window) {
  if (!(window > 0.0) || !std::isfinite(window))
    throw InvalidParameter(message("window is ", window, " but must be positive and finite"));
  return window;
}

}  // namespace

WindowedDrainage::WindowedDrainage(const SpotParameters& spots, const RelaxationParameters& relaxation,
                                   const DrainageLimits& limits, double window, int threads,
                                   std::shared_ptr<const Container> container, double diameter, double extent,
                                   const std::vector<Grain>& grains)
    : Drainage(spots, relaxation, limits, std::move(container), diameter),
      workers_(std::make_unique<Workers>(threads)),
      window_(positive_window(window)),
      due_(moves_until_due(spots, relaxation.tolerance * diameter)),
      packing_(diameter, extent, limits.outlet, grains, *container_),
      walk_(spots, *container_),
      next_birth_(walk_.time_before_birth(0)) {
  TiledPacking::require_radius(spots.radius, diameter);
  require_valid_start();
}

void WindowedDrainage::advance_to(double time) {
  // A time that was meant to be a whole number of windows may be off by rounding.
  while (static_cast<double>(windows_ + 1) * window_ <= time * (1.0 + 1e-12)) {
    const double until = static_cast<double>(++windows_) * window_;
    give_birth(until);
    walk(until);
    displace();
    relax();
    const std::size_t drained_before = drained_.size();
    packing_.take_out_below(limits_.outlet, drained_);
    counters_.drained += static_cast<std::int64_t>(drained_.size() - drained_before);
  }
}

void WindowedDrainage::give_birth(double until) {
  while (next_birth_ <= until) {
    spots_.push_back(walk_.birth(born_, next_birth_, container()));
    next_step_.push_back(spots_.back().next_step);
    weights_.push_back(1.0);
    next_birth_ += walk_.time_before_birth(++born_);
  }
}

void WindowedDrainage::walk(double until) {
  moves_.clear();
  movers_.clear();
  for (std::size_t k = 0; k < spots_.size(); ++k)
    while (next_step_[k] <= until) {
      moves_.push_back(walk_.step(spots_[k], container()));
      moves_.back().weight = weights_[k];
      movers_.push_back(k);
      next_step_[k] = spots_[k].next_step;
    }
}

void WindowedDrainage::displace() {
  packing_.displace(moves_, parameters_.radius, parameters_.influence, container(), *workers_, moved_);
  const double inside = container().orifice().centre.z() + parameters_.radius;
  for (std::size_t m = 0; m < moves_.size(); ++m) {
    ++counters_.moves;
    counters_.grains_moved += moved_[m];
    weights_[movers_[m]] = fixed_volume_weight(parameters_, moves_[m].middle.z() - limits_.outlet, moved_[m]);
    if (moved_[m] > 0 || moves_[m].middle.z() <= inside || next_step_[movers_[m]] == removed) continue;
    // Out at the top of the packing.
    next_step_[movers_[m]] = removed;
    ++removed_;
  }
  if (removed_ > spots_.size() / 16) drop_removed();
}

void WindowedDrainage::drop_removed() {
  std::size_t kept = 0;
  for (std::size_t k = 0; k < spots_.size(); ++k) {
    if (next_step_[k] == removed) continue;
    spots_[kept] = spots_[k];
    weights_[kept] = weights_[k];
    next_step_[kept++] = next_step_[k];
  }
  spots_.resize(kept);
  next_step_.resize(kept);
  weights_.resize(kept);
  removed_ = 0;
}

std::vector<Spot> WindowedDrainage::spots() const {
  std::vector<Spot> live;
  for (std::size_t k = 0; k < spots_.size(); ++k)
    if (next_step_[k] != removed) live.push_back(spots_[k]);
  return live;
}

void WindowedDrainage::relax() {
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    // Once a window only: a cell that is swept over and over on its own is pushed into its neighbours.
    const double deepest = sweep == 0 ? deepest_overlap : std::numeric_limits<double>::infinity();
    const std::size_t swept = packing_.sweep(relaxation_parameters_, due_, deepest, container(), *workers_);
    if (swept == 0) return;
    ++counters_.sweeps;
    counters_.grains_swept += static_cast<std::int64_t>(swept);
  }
}

void WindowedDrainage::replace_grains(const std::vector<Grain>& grains) {
  replace_if_inside(packing_,
                    TiledPacking(packing_.diameter(), packing_.extent(), limits_.outlet, grains, container()));
}

void WindowedDrainage::replace_container(std::shared_ptr<const Container> container) {
  container_ = std::move(container);
  packing_.mark_near_walls(*container_);
}

}  // namespace spot
