// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/drivers/drainage.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "spot/base/errors.hpp"
#include "spot/packing/displacement.hpp"

namespace spot {

namespace {

bool by_id(const Grain& a, const Grain& b) { return a.id < b.id; }

/// A grain at rest on the base has its centre this far from it, in diameters; no move may carry one through.
constexpr double longest_displacement = 0.5;

/// Steps of spots, in diameters: longer than any spot is wide, or too short to get anywhere.
constexpr double longest_step = 16.0, shortest_step = 1e-6;

/// Spots born while one climbs a diameter. The fitted parameters have 120.
constexpr double most_births = 1e7;

void require_steps(const SpotParameters& spots, double diameter) {
  if (!(diameter > 0.0) || !std::isfinite(diameter))
    throw InvalidParameter(message("grain diameter is ", diameter, " but must be positive and finite"));
  const double longest = std::max(spots.step_width, spots.step_height) / diameter;
  if (!(longest <= longest_step))
    throw InvalidParameter(
        message("steps of spots are ", longest, " diameters long but must be at most ", longest_step));
  if (!(spots.step_height >= shortest_step * diameter))
    throw InvalidParameter(message("spot step height is ", spots.step_height / diameter,
                                   " diameters but must be at least ", shortest_step));
  const double births = spots.injection_rate * (diameter / spots.speed);
  if (!(births <= most_births))
    throw InvalidParameter(message("spot injection rate is ", spots.injection_rate, ": ", births,
                                   " births while a spot climbs one diameter, but at most ", most_births,
                                   " are allowed"));
  const double step = std::sqrt(spots.step_width * spots.step_width + spots.step_height * spots.step_height);
  const double displacement = spots.influence * largest_weight(spots) * (step / diameter);
  if (!(displacement <= longest_displacement))
    throw InvalidParameter(message("a step of a spot displaces grains by up to ", displacement,
                                   " diameters, but at most ", longest_displacement,
                                   " is allowed: less influence or volume, or shorter steps"));
}

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
  require_steps(parameters_, diameter);
  container_->require_entrance(spots.equivalent_radius());
  container_->periodic().require_length(2.0 * (spots.radius + 2.0 * diameter),
                                        "twice the spot radius and two diameters, so that no spot meets itself");
  const double base = container_->orifice().centre.z();
  // A newborn spot is 2 R_s tall, and the middle of its first step is half a step higher.
  const double lowest_reached = base - 2.0 * spots.radius + 0.5 * spots.step_height;
  if (!(limits.outlet > lowest_reached && limits.outlet <= base))
    throw InvalidParameter(message("outlet is at z = ", limits.outlet, " but must be above ", lowest_reached,
                                   ", the reach of newborn spots, and not above the orifice, ", base));
  if (!(limits.largest_overlap_in_flow > 0.0))
    throw InvalidParameter(
        message("largest overlap in flow is ", limits.largest_overlap_in_flow, " diameters but must be positive"));
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

MovesReceived Drainage::take_moves_received() {
  MovesReceived received;
  if (received_) received.swap(*received_);
  return received;
}

/// Throws unless the grain is inside the walls or falling out of the orifice, above `lowest` and within `reach` of its
/// axis.
void Drainage::require_inside(const Grain& grain, double lowest, double reach) const {
  const Orifice& orifice = container_->orifice();
  const Vector3& centre = grain.position;
  const bool falling = centre.z() < orifice.centre.z() && centre.z() >= lowest &&
                       container_->periodic().nearest(Vector3(centre - orifice.centre)).head<2>().norm() <= reach;
  if (!falling && !container_->contains(centre))
    throw InvalidPacking(message("grain ", grain.id, " at (", centre.x(), ", ", centre.y(), ", ", centre.z(),
                                 ") is outside the container"));
}

void Drainage::require_inside() const {
  // Falling grains may spread below the plate, and those at the edge of a relaxed region leave one move later.
  constexpr double any = std::numeric_limits<double>::infinity();
  visit_grains([&](const Grain& grain) { require_inside(grain, -any, any); });
}

void Drainage::change_grains(const GrainChanges& changes) {
  for (const Grain& grain : changes.come) {
    require_inside(grain, limits_.outlet, container_->orifice().radius + diameter_);
    require_off_walls({depth_in_walls(grain), grain.id, grain.id}, "when it is put in");
  }
  require_shallow(carry_out(changes), "when they are put in");
}

void Drainage::replace_grains(const std::vector<Grain>& grains) {
  GrainChanges changes;
  std::map<std::int64_t, Grain> old;
  visit_grains([&](const Grain& grain) { old.emplace(grain.id, grain); });
  for (Grain grain : grains) {
    for (double& at : grain.position) at = quantum().snap(at);
    grain.radius = radius_in(diameter_, grain);
    const auto same = old.find(grain.id);
    if (same != old.end() && same->second == grain)
      old.erase(same);
    else
      changes.come.push_back(grain);
  }
  for (const auto& [id, grain] : old) changes.gone.push_back(id);
  change_grains(changes);
}

void Drainage::require_no_collapse(const Overlap& largest) const {
  if (largest.depth > overlap_allowed())
    throw CollapsedPacking(message("grains ", largest.first, " and ", largest.second, " overlap by ", largest.depth,
                                   " diameters in flow; at most ", overlap_allowed(),
                                   " is allowed: relax more, or let spots displace less at a time"));
}

void Drainage::require_left_through_orifice(std::size_t first) const {
  for (std::size_t k = first; k < drained_.size(); ++k) {
    const Vector3& centre = drained_[k].position;
    if (container_->may_have_left_to(centre)) continue;
    throw CollapsedPacking(message("grain ", drained_[k].id, " at (", centre.x(), ", ", centre.y(), ", ", centre.z(),
                                   ") left through the base, beside the orifice of radius ",
                                   container_->orifice().radius, ": relax more, or let spots displace less at a time"));
  }
}

/// How deep a grain overlaps a wall, in diameters, or 0. Held grains may be part of the walls, and there are none below
/// the orifice.
double Drainage::depth_in_walls(const Grain& grain) const {
  const double radius = radius_in(diameter_, grain);
  if (grain.held || grain.position.z() < container_->orifice().centre.z()) return 0.0;
  WallContacts contacts;
  container_->contacts(grain.position, radius, contacts);
  double deepest = 0.0;
  for (const WallContact& contact : contacts)
    deepest = std::max(deepest, radius / diameter_ - contact.distance / diameter_);
  return deepest;
}

void Drainage::require_off_walls(const Overlap& deepest, const char* when) const {
  if (deepest.depth > limits_.largest_overlap)
    throw InvalidPacking(message("grain ", deepest.first, " overlaps a wall by ", deepest.depth, " diameters ", when,
                                 "; at most ", limits_.largest_overlap, " is allowed"));
}

void Drainage::require_shallow(const Overlap& overlap, const char* when) const {
  if (overlap.depth > limits_.largest_overlap)
    throw InvalidPacking(message("grains ", overlap.first, " and ", overlap.second, " overlap by ", overlap.depth,
                                 " diameters ", when, "; at most ", limits_.largest_overlap, " is allowed"));
}

void Drainage::require_valid_start() {
  Overlap in_wall;  // of the grain with the lowest id among the deepest
  visit_grains([&](const Grain& grain) {
    require_inside(grain, limits_.outlet, container_->orifice().radius + diameter_);
    const double depth = depth_in_walls(grain);
    if (depth > in_wall.depth || (depth == in_wall.depth && grain.id < in_wall.first))
      in_wall = {depth, grain.id, grain.id};
  });
  require_off_walls(in_wall, "at the start");
  require_shallow(largest_overlap(), "at the start");
}

}  // namespace spot
