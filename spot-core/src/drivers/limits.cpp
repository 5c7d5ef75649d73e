// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/drivers/limits.hpp"

#include <limits>

#include "spot/base/errors.hpp"

namespace spot {

namespace {

/// Grains may leave so far beside one of several holes, in diameters: those that a gate has held at its rim, when it
/// opens, are drawn past that where another outlet is near.
constexpr double beside_hole = 0.25;

}  // namespace

void DrainageLimits::validate() const {
  if (!(largest_overlap_in_flow > 0.0))
    throw InvalidParameter(
        message("largest overlap in flow is ", largest_overlap_in_flow, " diameters but must be positive"));
  if (!(largest_overlap > 0.0))
    throw InvalidParameter(
        message("largest overlap at the start is ", largest_overlap, " diameters but must be positive"));
}

GrainChecks::GrainChecks(const DrainageLimits& limits, std::shared_ptr<const Container> container, double diameter)
    : limits_(limits), container_(std::move(container)), diameter_(diameter) {
  limits_.validate();
}

/// Throws unless the grain is inside the walls or falling out of an outlet, above `lowest` and no farther than
/// `beside` from under its hole (length).
void GrainChecks::require_inside(const Grain& grain, double lowest, double beside) const {
  const Vector3& centre = grain.position;
  const bool falling =
      centre.z() < container_->outlets().height() && centre.z() >= lowest && container_->is_over_outlet(centre, beside);
  if (!falling && !container_->contains(centre))
    throw InvalidPacking(message("grain ", grain.id, " at (", centre.x(), ", ", centre.y(), ", ", centre.z(),
                                 ") is outside the container"));
}

void GrainChecks::require_inside(const Grain& grain) const {
  // Falling grains may spread below the plate, and those at the edge of a relaxed region leave one move later.
  constexpr double any = std::numeric_limits<double>::infinity();
  require_inside(grain, -any, any);
}

void GrainChecks::require_valid_place(const Grain& grain) const { require_inside(grain, limits_.outlet, diameter_); }

double GrainChecks::depth_in_walls(const Grain& grain) const {
  const double radius = radius_in(diameter_, grain);
  if (grain.held || grain.position.z() < container_->outlets().height()) return 0.0;
  WallContacts contacts;
  container_->contacts(grain.position, radius, contacts);
  double deepest = 0.0;
  for (const WallContact& contact : contacts)
    deepest = std::max(deepest, radius / diameter_ - contact.distance / diameter_);
  return deepest;
}

void GrainChecks::require_off_walls(const Overlap& deepest, const char* when) const {
  if (deepest.depth > limits_.largest_overlap)
    throw InvalidPacking(message("grain ", deepest.first, " overlaps a wall by ", deepest.depth, " diameters ", when,
                                 "; at most ", limits_.largest_overlap, " is allowed"));
}

void GrainChecks::require_shallow(const Overlap& largest, const char* when) const {
  if (largest.depth > limits_.largest_overlap)
    throw InvalidPacking(message("grains ", largest.first, " and ", largest.second, " overlap by ", largest.depth,
                                 " diameters ", when, "; at most ", limits_.largest_overlap, " is allowed"));
}

void GrainChecks::require_no_collapse(const Overlap& largest) const {
  if (largest.depth > limits_.overlap_allowed())
    throw CollapsedPacking(message("grains ", largest.first, " and ", largest.second, " overlap by ", largest.depth,
                                   " diameters in flow; at most ", limits_.overlap_allowed(),
                                   " is allowed: relax more, or let spots displace less at a time"));
}

void GrainChecks::require_left_through_orifice(const std::vector<Grain>& drained) const {
  const double beside = container_->outlets().size() > 1 ? beside_hole * diameter_ : 0.0;
  for (const Grain& grain : drained) {
    const Vector3& centre = grain.position;
    if (container_->may_have_left_to(centre) || (beside > 0.0 && container_->is_over_outlet(centre, beside))) continue;
    throw CollapsedPacking(message("grain ", grain.id, " at (", centre.x(), ", ", centre.y(), ", ", centre.z(),
                                   ") left through the base, beside the ", container_->nearest_outlet(centre).name(),
                                   ": relax more, or let spots displace less at a time"));
  }
}

}  // namespace spot
