// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/drainage.hpp"

#include <algorithm>

#include "spot/displacement.hpp"
#include "spot/errors.hpp"

namespace spot {

Drainage::Drainage(const SpotParameters& spots, const RelaxationParameters& relaxation, const DrainageLimits& limits,
                   std::shared_ptr<const Container> container, Packing packing)
    : parameters_(spots),
      limits_(limits),
      container_(std::move(container)),
      packing_(std::move(packing)),
      population_(spots, *container_),
      relaxation_(relaxation) {
  const double base = container_->orifice().centre.z();
  const double lowest_reached = base - 2.0 * spots.radius;
  if (!(limits.outlet > lowest_reached && limits.outlet <= base))
    throw InvalidParameter(message("outlet is at z = ", limits.outlet, " but must be above ", lowest_reached,
                                   ", the reach of newborn spots, and not above the orifice, ", base));
  require_valid_start(packing_, *container_, limits.largest_overlap);
}

void Drainage::replace(std::shared_ptr<const Container> container, Packing packing) {
  require_valid_start(packing, *container, limits_.largest_overlap);
  container_ = std::move(container);
  packing_ = std::move(packing);
}

void Drainage::require_inside() const {
  const double base = container_->orifice().centre.z();
  for (std::size_t i = 0; i < packing_.slots(); ++i)
    if (packing_.present(i) && packing_.z()[i] >= base && !container_->contains(packing_.position(i)))
      throw InvalidPacking(message("grain ", packing_.id(i), " has left the container at (", packing_.x()[i], ", ",
                                   packing_.y()[i], ", ", packing_.z()[i],
                                   "): the relaxation is too weak for these spots"));
}

void Drainage::advance_to(double time) {
  while (const auto move = population_.next_move(time, *container_)) carry_out(*move);
}

void Drainage::carry_out(const Move& move) {
  packing_.refresh(*container_);
  const double reach = parameters_.radius + relaxation_.parameters().shell * packing_.diameter();
  packing_.find_movable(move.middle, reach, near_);
  const int moved = displace(packing_, near_, move, parameters_.radius, parameters_.influence);
  ++counters_.moves;
  counters_.grains_moved += moved;
  if (moved == 0) {
    // Below the orifice a spot may meet no grains yet; above it, it has come out at the top of the packing.
    if (move.middle.z() > container_->orifice().centre.z() + parameters_.radius) population_.remove_last_moved();
    return;
  }
  const int every = relaxation_.parameters().every;
  if (every > 0 && counters_.moves % every == 0) {
    packing_.update_lists(*container_);
    relaxation_.sweep(packing_, *container_, near_);
    ++counters_.sweeps;
  }
  if (move.middle.z() - reach < limits_.outlet) take_out_drained();
}

void Drainage::take_out_drained() {
  packing_.update_lists(*container_);
  for (const std::uint32_t i : near_) {
    if (packing_.z()[i] >= limits_.outlet) continue;
    drained_.push_back(packing_.remove(i));
    ++counters_.drained;
  }
}

Overlap Drainage::largest_overlap() {
  packing_.refresh(*container_);
  return packing_.largest_overlap();
}

std::vector<Grain> Drainage::take_drained() {
  std::vector<Grain> drained;
  drained.swap(drained_);
  std::sort(drained.begin(), drained.end(), [](const Grain& a, const Grain& b) { return a.id < b.id; });
  return drained;
}

void require_valid_start(Packing& packing, const Container& container, double largest_overlap) {
  packing.refresh(container);
  for (const Grain& grain : packing.grains())
    if (!container.contains(grain.position))
      throw InvalidPacking(message("grain ", grain.id, " at (", grain.position.x(), ", ", grain.position.y(), ", ",
                                   grain.position.z(), ") is outside the container"));
  const Overlap overlap = packing.largest_overlap();
  if (overlap.depth > largest_overlap * packing.diameter())
    throw InvalidPacking(message("grains ", overlap.first, " and ", overlap.second, " overlap by ",
                                 overlap.depth / packing.diameter(), " diameters at the start; at most ",
                                 largest_overlap, " is allowed"));
}

}  // namespace spot
