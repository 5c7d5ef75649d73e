// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/drainage.hpp"

#include <algorithm>
#include <limits>

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
  // A newborn spot is 2 R_s tall, and the middle of its first step is half a step higher.
  const double lowest_reached = base - 2.0 * spots.radius + 0.5 * spots.step_height;
  if (!(limits.outlet > lowest_reached && limits.outlet <= base))
    throw InvalidParameter(message("outlet is at z = ", limits.outlet, " but must be above ", lowest_reached,
                                   ", the reach of newborn spots, and not above the orifice, ", base));
  if (!(limits.largest_overlap > 0.0))
    throw InvalidParameter(message("largest overlap at the start is ", limits.largest_overlap,
                                   " diameters but must be positive"));
  require_valid_start();
}

/// Throws InvalidPacking, naming the grain, if one is neither inside the walls nor falling out of the orifice,
/// above `lowest` and within `reach` of its axis.
static void require_inside(const Packing& packing, const Container& container, double lowest, double reach) {
  const Orifice& orifice = container.orifice();
  for (std::size_t i = 0; i < packing.slots(); ++i) {
    if (!packing.present(i)) continue;
    const Vector3 centre = packing.position(i);
    const bool falling = centre.z() < orifice.centre.z() && centre.z() >= lowest &&
                         (centre - orifice.centre).head<2>().norm() <= reach;
    if (!falling && !container.contains(centre))
      throw InvalidPacking(message("grain ", packing.id(i), " at (", centre.x(), ", ", centre.y(), ", ", centre.z(),
                                   ") is outside the container"));
  }
}

void Drainage::require_inside() const {
  // Falling grains may spread below the plate, and those at the edge of a relaxed region leave one move later.
  spot::require_inside(packing_, *container_, limits_.outlet - packing_.diameter(),
                       std::numeric_limits<double>::infinity());
}

void Drainage::require_valid_start() {
  spot::require_inside(packing_, *container_, limits_.outlet, container_->orifice().radius + packing_.diameter());
  const Overlap overlap = largest_overlap();
  if (overlap.depth > limits_.largest_overlap * packing_.diameter())
    throw InvalidPacking(message("grains ", overlap.first, " and ", overlap.second, " overlap by ",
                                 overlap.depth / packing_.diameter(), " diameters at the start; at most ",
                                 limits_.largest_overlap, " is allowed"));
}

void Drainage::replace(std::shared_ptr<const Container> container, Packing packing) {
  spot::require_inside(packing, *container, limits_.outlet - packing.diameter(),
                       std::numeric_limits<double>::infinity());
  container_ = std::move(container);
  packing_ = std::move(packing);
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

}  // namespace spot
