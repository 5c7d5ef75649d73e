// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/time_ordered_drainage.hpp"

#include "spot/displacement.hpp"

namespace spot {

TimeOrderedDrainage::TimeOrderedDrainage(const SpotParameters& spots, const RelaxationParameters& relaxation,
                                         const DrainageLimits& limits, std::shared_ptr<const Container> container,
                                         Packing packing)
    : Drainage(spots, relaxation, limits, std::move(container), packing.diameter()),
      packing_(std::move(packing)),
      population_(spots, *container_),
      relaxation_(relaxation) {
  require_valid_start();
}

void TimeOrderedDrainage::advance_to(double time) {
  while (const auto move = population_.next_move(time, container())) carry_out(*move);
}

void TimeOrderedDrainage::carry_out(const Move& move) {
  packing_.refresh(container());
  const double reach = parameters_.radius + relaxation_parameters_.shell * packing_.diameter();
  packing_.find_movable(move.middle, reach, near_);
  const int moved = displace(packing_, near_, move, parameters_.radius, parameters_.influence);
  ++counters_.moves;
  counters_.grains_moved += moved;
  if (moved == 0) {
    // Below the orifice a spot may meet no grains yet; above it, it has come out at the top of the packing.
    if (move.middle.z() > container().orifice().centre.z() + parameters_.radius) population_.remove_last_moved();
    return;
  }
  const int every = relaxation_parameters_.every;
  if (every > 0 && counters_.moves % every == 0) {
    packing_.update_lists(container());
    relaxation_.sweep(packing_, container(), near_);
    ++counters_.sweeps;
    counters_.grains_swept += static_cast<std::int64_t>(near_.size());
  }
  if (move.middle.z() - reach < limits_.outlet) take_out_drained();
}

void TimeOrderedDrainage::take_out_drained() {
  packing_.update_lists(container());
  for (const std::uint32_t i : near_) {
    if (packing_.z()[i] >= limits_.outlet) continue;
    drained_.push_back(packing_.remove(i));
    ++counters_.drained;
  }
}

void TimeOrderedDrainage::replace_grains(const std::vector<Grain>& grains) {
  replace_if_inside(packing_, Packing(packing_.diameter(), packing_.extent(), grains));
}

void TimeOrderedDrainage::replace_container(std::shared_ptr<const Container> container) {
  container_ = std::move(container);
  packing_.mark_near_walls(*container_);
}

void TimeOrderedDrainage::visit_grains(const std::function<void(const Grain&)>& visit) const {
  for (std::size_t i = 0; i < packing_.slots(); ++i)
    if (packing_.present(i)) visit({packing_.id(i), packing_.position(i), packing_.held(i)});
}

Overlap TimeOrderedDrainage::largest_overlap() {
  packing_.refresh(container());
  return packing_.largest_overlap();
}

}  // namespace spot
