// SPDX-License-Identifier: GPL-2.0-or-later
#include "spot/walk/spot_walk.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "spot/base/errors.hpp"
#include "spot/base/random.hpp"

namespace spot {

namespace {

/// Of the birth of a spot: waiting time before it, two for its place in an outlet, and which outlet.
std::array<double, 4> numbers_of_birth(const SpotParameters& p, std::int64_t id) {
  return uniform(p.seed, RandomPurpose::birth, static_cast<std::uint64_t>(id), 0);
}

/// Numbers of the step to come: waiting time before it, its direction, a lot for others, and whether it changes
/// direction at all.
std::array<double, 4> numbers_of_step(const SpotParameters& p, const Spot& spot) {
  return uniform(p.seed, RandomPurpose::step, static_cast<std::uint64_t>(spot.id),
                 static_cast<std::uint64_t>(spot.steps));
}

constexpr int directions = 4;

/// A uniform number that gives one of them.
double number_of_direction(int direction) { return (direction + 0.5) / directions; }

/// One of the four vectors (+-dx, 0, dz), (0, +-dx, dz) (2006; trap: 2010 prints diagonals that spread twice as fast).
Vector3 step_vector(const SpotParameters& p, double uniform) {
  switch (static_cast<int>(directions * uniform)) {
    case 0:
      return {p.step_width, 0.0, p.step_height};
    case 1:
      return {-p.step_width, 0.0, p.step_height};
    case 2:
      return {0.0, p.step_width, p.step_height};
    default:
      return {0.0, -p.step_width, p.step_height};
  }
}

/// One of them, by their weights and a uniform number; all are equally likely where none has any weight.
int chosen(const std::array<double, directions>& weights, double uniform) {
  double sum = 0.0;
  for (const double weight : weights) sum += weight;
  if (sum == 0.0) return std::min(directions - 1, static_cast<int>(uniform * directions));
  double left = uniform * sum;
  for (int k = 0; k < directions - 1; ++k) {
    const double weight = weights[static_cast<std::size_t>(k)];
    if (left < weight) return k;
    left -= weight;
  }
  return directions - 1;
}

/// The number that gives the step to the other side.
double opposite(double uniform) {
  const bool odd = static_cast<int>(4.0 * uniform) % 2 == 1;
  return odd ? uniform - 0.25 : uniform + 0.25;
}

}  // namespace

SpotWalk::SpotWalk(const SpotParameters& parameters, const Container& container) : parameters_(parameters) {
  parameters_.validate();
  if (parameters_.injection_rate.outlets() != container.outlets().size())
    throw InvalidParameter(message("spot injection rates are for ", parameters_.injection_rate.outlets(),
                                   " outlets but the container has ", container.outlets().size()));
  container.require_entrance(parameters_.equivalent_radius());
}

double SpotWalk::births_expected(std::int64_t id) const {
  return exponential(numbers_of_birth(parameters_, id)[0], 1.0);
}

Spot SpotWalk::birth(std::int64_t id, double time, const Container& container) const {
  const auto numbers = numbers_of_birth(parameters_, id);
  const std::size_t at = parameters_.injection_rate.outlet_of_birth(time, numbers[3]);
  const Outlet& outlet = container.outlets()[at];
  Spot spot{id, 0, outlet.centre, time};
  spot.outlet = static_cast<std::int64_t>(at);
  Vector3 from_centre = outlet.hole->point(parameters_.radius, numbers[1], numbers[2]);
  from_centre.z() = -parameters_.radius;
  spot.position = container.periodic().wrap(spot.position + from_centre);
  draw_next_step(spot);
  return spot;
}

void SpotWalk::draw_next_step(Spot& spot) const {
  const auto numbers = numbers_of_step(parameters_, spot);
  if (spot.steps == 0 || numbers[3] >= parameters_.persistence) spot.direction = numbers[1];
  spot.chance = numbers[2];
  const double mean = parameters_.mean_waiting_time();
  if (!parameters_.together)
    spot.next_step += exponential(numbers[0], parameters_.move_rate()) / spot.relative_speed;
  else if (spot.steps == 0)
    spot.next_step = (std::floor(spot.next_step / mean) + 1.0) * mean;
  else
    spot.next_step = std::nearbyint(spot.next_step / mean + 1.0) * mean;
}

void SpotWalk::set_relative_speed(Spot& spot, double time, double relative_speed) const {
  spot.next_step = time + (spot.next_step - time) * (spot.relative_speed / relative_speed);
  spot.relative_speed = relative_speed;
}

/// Of spots there, sideways, for each length that they climb.
Vector3 SpotWalk::drift(const Vector3& place, const FreeSurface& surface, const FlowField& flow) const {
  const double depth = surface.height(place) - place.z();
  const double shear = flow.shear(place) + (depth > 0.0 ? parameters_.wall_shear / depth : 0.0);
  Vector3 drift = Vector3::Zero();
  if (shear > 0.0) drift = (parameters_.diffusion_length() - parameters_.spread / shear) * flow.slope(place);
  if (parameters_.mobility.on()) drift += parameters_.mobility.drift * flow.slope_of_mobility(place);
  return drift;
}

/// Chooses the direction once more, with the same number: by how much of the spot each would keep below the surface,
/// and so that spots drift on average as the flow wants it.
void SpotWalk::steer(Spot& spot, const Container& container, const FreeSurface& surface, const FlowField& flow) const {
  const bool near_surface = surface.steers() && surface.is_near(spot.position), drifts = parameters_.spread > 0.0;
  if (!near_surface && !drifts) return;
  std::array<double, directions> weights = {1.0, 1.0, 1.0, 1.0};
  if (drifts) {
    // A step along x is one of two in four: chances (1 +- e) / 4 make a mean of e dx / 2 for each dz.
    const Vector3 e = 2.0 * parameters_.step_height / parameters_.step_width * drift(spot.position, surface, flow);
    weights = {1.0 + e.x(), 1.0 - e.x(), 1.0 + e.y(), 1.0 - e.y()};
    for (double& weight : weights) weight = std::clamp(weight, 0.0, 2.0);
  }
  if (near_surface)
    for (int k = 0; k < directions; ++k) {
      const Vector3 target = spot.position + step_vector(parameters_, number_of_direction(k));
      const Vector3 middle = 0.5 * (spot.position + container.keep_spot_inside(spot.position, target));
      weights[static_cast<std::size_t>(k)] *= surface.weight(middle);
    }
  spot.direction = number_of_direction(chosen(weights, spot.direction));
}

Move SpotWalk::step(Spot& spot, const Container& container, const FreeSurface& surface, const FlowField& flow) const {
  Move move;
  move.time = spot.next_step;
  move.spot = spot.id;
  const Vector3 start = spot.position;
  steer(spot, container, surface, flow);
  const Vector3 target = start + step_vector(parameters_, spot.direction);
  spot.position = container.keep_spot_inside(start, target);
  // A spot that a wall has reflected goes on away from it, if it goes on its way.
  if (spot.position != target) spot.direction = opposite(spot.direction);
  move.middle = 0.5 * (start + spot.position);
  move.step = spot.position - start;
  spot.position = container.periodic().wrap(spot.position);
  move.number = ++spot.steps;
  move.chance = spot.chance;
  draw_next_step(spot);
  return move;
}

}  // namespace spot
