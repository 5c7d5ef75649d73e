// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/windowed_drainage.hpp"

#include <algorithm>
#include <limits>

namespace spot {

WindowedDrainage::WindowedDrainage(const SpotParameters& spots, const RelaxationParameters& relaxation,
                                   const DrainageLimits& limits, const WindowParameters& window,
                                   std::shared_ptr<const Container> container, double diameter, double extent,
                                   const std::vector<Grain>& grains)
    : parameters_(spots),
      relaxation_(relaxation),
      limits_(limits),
      window_(window),
      container_(std::move(container)),
      packing_(diameter, extent, limits.outlet, grains, *container_),
      walk_(spots, *container_),
      next_birth_(walk_.time_before_birth(0)) {}

void WindowedDrainage::advance_to(double time) {
  while (static_cast<double>(windows_ + 1) * window_.window <= time * (1.0 + 1e-12)) {
    const double until = static_cast<double>(++windows_) * window_.window;
    give_birth(until);
    walk(until);
    packing_.update_lists(*container_);
    relax();
    packing_.take_out_below(limits_.outlet, drained_);
  }
}

void WindowedDrainage::give_birth(double until) {
  while (next_birth_ <= until) {
    spots_.push_back(walk_.birth(born_, next_birth_, *container_));
    next_step_.push_back(spots_.back().next_step);
    next_birth_ += walk_.time_before_birth(++born_);
  }
}

void WindowedDrainage::walk(double until) {
  const double inside = container_->orifice().centre.z() + parameters_.radius;
  for (std::size_t k = 0; k < spots_.size(); ++k) {
    while (next_step_[k] <= until) {
      const Move move = walk_.step(spots_[k], *container_);
      next_step_[k] = spots_[k].next_step;
      const int moved = packing_.displace(move, parameters_.radius, parameters_.influence);
      ++counters_.moves;
      counters_.grains_moved += moved;
      if (moved == 0 && move.middle.z() > inside) {
        next_step_[k] = std::numeric_limits<double>::infinity();
        ++removed_;
      }
    }
  }
  if (removed_ > spots_.size() / 16) drop_removed();
}

void WindowedDrainage::drop_removed() {
  std::size_t kept = 0;
  for (std::size_t k = 0; k < spots_.size(); ++k) {
    if (next_step_[k] == std::numeric_limits<double>::infinity()) continue;
    spots_[kept] = spots_[k];
    next_step_[kept++] = next_step_[k];
  }
  spots_.resize(kept);
  next_step_.resize(kept);
  removed_ = 0;
}

void WindowedDrainage::relax() {
  for (int round = 0; round < window_.rounds; ++round) {
    const std::size_t swept = packing_.sweep(relaxation_, window_.due, window_.relief, *container_);
    if (swept == 0) return;
    counters_.sweeps += static_cast<std::int64_t>(swept);
    packing_.update_lists(*container_);
  }
}

std::vector<Grain> WindowedDrainage::take_drained() {
  std::vector<Grain> drained;
  drained.swap(drained_);
  counters_.drained += static_cast<std::int64_t>(drained.size());
  return drained;
}

}  // namespace spot
