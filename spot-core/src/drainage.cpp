// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/drainage.hpp"

#include <algorithm>
#include <limits>

#include "spot/errors.hpp"

namespace spot {

namespace {

bool by_id(const Grain& a, const Grain& b) { return a.id < b.id; }

}  // namespace

Drainage::Drainage(const SpotParameters& spots, const RelaxationParameters& relaxation, const DrainageLimits& limits,
                   std::shared_ptr<const Container> container, double diameter)
    : parameters_(spots),
      relaxation_parameters_(relaxation),
      limits_(limits),
      container_(std::move(container)),
      diameter_(diameter) {
  parameters_.validate();
  relaxation_parameters_.validate();
  container_->require_entrance(spots.radius);
  const double base = container_->orifice().centre.z();
  // A newborn spot is 2 R_s tall, and the middle of its first step is half a step higher.
  const double lowest_reached = base - 2.0 * spots.radius + 0.5 * spots.step_height;
  if (!(limits.outlet > lowest_reached && limits.outlet <= base))
    throw InvalidParameter(message("outlet is at z = ", limits.outlet, " but must be above ", lowest_reached,
                                   ", the reach of newborn spots, and not above the orifice, ", base));
  if (!(limits.largest_overlap > 0.0))
    throw InvalidParameter(
        message("largest overlap at the start is ", limits.largest_overlap, " diameters but must be positive"));
}

std::vector<Grain> Drainage::grains() const {
  std::vector<Grain> all;
  visit_grains([&](const Grain& grain) { all.push_back(grain); });
  std::sort(all.begin(), all.end(), by_id);
  return all;
}

std::vector<Grain> Drainage::take_drained() {
  std::vector<Grain> drained;
  drained.swap(drained_);
  std::sort(drained.begin(), drained.end(), by_id);
  return drained;
}

/// Throws unless every grain is inside the walls or falling out of the orifice, above `lowest` and within `reach` of
/// its axis.
void Drainage::require_inside(double lowest, double reach) const {
  const Orifice& orifice = container_->orifice();
  visit_grains([&](const Grain& grain) {
    const Vector3& centre = grain.position;
    const bool falling =
        centre.z() < orifice.centre.z() && centre.z() >= lowest && (centre - orifice.centre).head<2>().norm() <= reach;
    if (!falling && !container_->contains(centre))
      throw InvalidPacking(message("grain ", grain.id, " at (", centre.x(), ", ", centre.y(), ", ", centre.z(),
                                   ") is outside the container"));
  });
}

void Drainage::require_inside() const {
  // Falling grains may spread below the plate, and those at the edge of a relaxed region leave one move later.
  require_inside(-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity());
}

void Drainage::require_valid_start() {
  require_inside(limits_.outlet, container_->orifice().radius + diameter_);
  const Overlap overlap = largest_overlap();
  if (overlap.depth > limits_.largest_overlap)
    throw InvalidPacking(message("grains ", overlap.first, " and ", overlap.second, " overlap by ", overlap.depth,
                                 " diameters at the start; at most ", limits_.largest_overlap, " is allowed"));
}

}  // namespace spot
